// Data of the kernels that look up a table of radiance, and their entry points for every
// instruction set.
#pragma once

namespace plenoflame {

/// A table of radiance over the lines through two planes across the camera's axis. The anchor's
/// plane has coordinates a, b, and the plane of the entrance pupil u, v. Blocks of 8 x 8 cells in a
/// and b hold 9 x 9 x side x side nodes, u varying fastest.
struct KernelRadianceTable {
  float rotation[9];             ///< camera to world, row major
  float a0, b0, per_step;        ///< [m, 1/m] first node, relative to the anchor; nodes per metre
  float u0, v0, per_pupil_step;  ///< the same on the plane of the pupil
  float to_pupil;                ///< [m] along the axis from the anchor's plane to the pupil's
  int cells_a, cells_b, cells_u;
  int blocks_a;  ///< blocks in a row
  int blank;     ///< a block of zeros, for rays outside
  int side;      ///< nodes in u and in v: cells_u + 1
  int channels, channel_stride, block_stride;
  /// Largest (greatest - least) / least of the corners of smooth and of fair cells.
  float smooth, fair;
};

/// Positions of rays in the table; structure of arrays.
struct KernelTablePlaces {
  int* block;            ///< -1: outside of the table
  int* corner;           ///< lowest corner within its block
  float *a, *b, *u, *v;  ///< within the cell, 0 to 1
};

#define PLENOFLAME_RADIANCE_TABLE_KERNELS                                                          \
  /* Rays relative to the anchor, world axes; those with code 0 only, others are outside.       */ \
  void locate(const KernelRadianceTable&, int count, const float* x, const float* y,               \
              const float* z, const float* dx, const float* dy, const float* dz, const int* code,  \
              const KernelTablePlaces&);                                                           \
  /* Radiance of channel c at radiance + c * stride, 0 outside; quality, of the worst channel: */  \
  /* 2 smooth, 1 fair, 0 neither or outside. */                                                    \
  void look_up(const KernelRadianceTable&, const float* nodes, int count,                          \
               const KernelTablePlaces&, float* radiance, int stride, int* quality);

namespace baseline {
PLENOFLAME_RADIANCE_TABLE_KERNELS
}
namespace avx2 {
PLENOFLAME_RADIANCE_TABLE_KERNELS
}
namespace avx512 {
PLENOFLAME_RADIANCE_TABLE_KERNELS
}

}  // namespace plenoflame
