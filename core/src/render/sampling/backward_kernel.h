// Data of the backward estimator's vector kernels, and their entry points for every instruction
// set.
#pragma once
#include <cstdint>

#include "camera/camera_kernel.h"
#include "plenoflame/camera/cut_kernel.h"

namespace plenoflame {

/// The crossing of rays with a surface behind the microlens (camera/stop_landing.h, RayCrossing).
template <class Real>
struct KernelCrossing {
  Real of_sensor[10], of_aim[10];
};

/// The light that a pixel records from beside it (camera.sensor.blur), along a row and likewise
/// along a column. Shares from 0 to 1 represent offsets from the pixel's middle, in pixels. The
/// weight of a point is interpolated between `low` and `high` of its cell.
template <class Real>
struct KernelBlur {
  static constexpr int kCells = 1024;
  Real at[kCells + 1], low[kCells], high[kCells];
};

/// A microlens and the bounds of the rays that pass it (camera/pupil_sampling.h). Positions are
/// relative to its centre (without array: to the optical axis).
template <class Real>
struct KernelFrame {
  Real lens_x, lens_y;      ///< centre of the microlens
  Real centre_x, centre_y;  ///< sensor point of the micro-image through which the cuts' axes run
  Real origin_x, origin_y,
      origin_shift;  ///< aim points count from (origin_x, origin_y) + origin_shift * s
  /// The discs of the microlens' own apertures (ApertureDiscs), relative to the origin.
  Real near_radius, near_shift, far_radius, far_growth, far_shift, far_bend;
  /// Crossings of rays with the microlens' far face and the stop, if they are known. They take
  /// sensor and aim points times per_unit. The stop's axes (StopMap) are along `field`, away from
  /// the optical axis.
  bool finds_far, finds_stop;
  Real per_unit, far_reach, stop_reach, field_x, field_y;
  KernelCrossing<Real> at_far, at_pupil;
  Real along[6], across[4];
  /// Pairs of sides of the microlens' two apertures in the aim plane (ApertureSides); 0 for
  /// circles.
  int side_pairs;
  Real side_x[kMostSidePairs], side_y[kMostSidePairs];
  Real near_half[kMostSidePairs], far_half[kMostSidePairs];
  /// Exact sides, if all lenses of a type are equal. The members are half the distance of the sides
  /// on the faces, the near face's curvature (as KernelSurface), and one over the far aperture's
  /// radius.
  bool finds_sides;
  Real face_half[kMostSidePairs], near_curvature, per_far_radius;
  const KernelBlur<Real>* blur;  ///< nullptr: pixels record only light that arrives on them
  Real pitch_x, pitch_y;         ///< of the pixels, with blur
};

/// A pixel that the microlens of a frame may light, and its random numbers.
template <class Real>
struct KernelPixel {
  Real x_low, x_width;    ///< lit columns; with blur, shares of KernelBlur
  Real y0, y1;            ///< lit rows; with blur, shares
  Real x, y;              ///< middle of the pixel, with blur
  Real radius2;           ///< squared radius of the lit disc about the frame's centre
  const CutColumn* cuts;  ///< of the aperture, about the frame's centre
  const std::uint32_t* fractions[4];
  /// Digital shift of each dimension: shift ^ second_shift * number of the replicate (SobolPool).
  std::uint32_t shift[4], second_shift[4];
  const std::uint32_t* replicate_numbers;
  int first, count;  ///< rays of the block
};

#define PLENOFLAME_BACKWARD_KERNELS                                                                \
  /* Fills the rays of all pixels, which follow one another in the block, at the aim plane, which  \
   * is `distance` from the sensor; up to 16 rays behind the last are overwritten.              */ \
  void generate(const KernelFrame<float>&, const KernelPixel<float>*, int pixels, float distance,  \
                const KernelBlock<float>&);                                                        \
  void generate(const KernelFrame<double>&, const KernelPixel<double>*, int pixels,                \
                double distance, const KernelBlock<double>&);                                      \
  /* weight * radiance. */                                                                         \
  void multiply(const float* weight, const float* radiance, int count, float* products);           \
  void multiply(const double* weight, const double* radiance, int count, double* products);        \
  /* sums[i] = values[i] + values[i + distance]. */                                                \
  void add_neighbours(const float* values, int distance, int count, float* sums);                  \
  void add_neighbours(const double* values, int distance, int count, double* sums);                \
  /* Of weight * radiance, in double precision. */                                                 \
  double sum(const float* weight, const float* radiance, int count);                               \
  double sum(const double* weight, const double* radiance, int count);

namespace baseline {
PLENOFLAME_BACKWARD_KERNELS
}
namespace avx2 {
PLENOFLAME_BACKWARD_KERNELS
}
namespace avx512 {
PLENOFLAME_BACKWARD_KERNELS
}

}  // namespace plenoflame
