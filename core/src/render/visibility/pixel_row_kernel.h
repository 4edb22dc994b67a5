// Questions about rows of pixels behind a microlens before rays are drawn, for every instruction
// set.
#pragma once
#include <cstdint>

#include "plenoflame/camera/cut_kernel.h"

namespace plenoflame {

inline constexpr int kRowsPixels = 256;  ///< looked at together, at most
inline constexpr int kRowLanes = 8;      ///< of them in a vector
inline constexpr int kWorthRings = 6;
/// Counters of random bits, for each pixel: one of pixel and microlens, and those of its
/// successors, from one to four more. Whatever else is made of the first one adds a number of its
/// own, far from these.
inline constexpr int kRowWords = 5;

/// Rows of pixels; all lengths from the microlens' centre [m]. A pixel's own is at
/// x = (half_columns - (column + 1/2)) pitch - lens_x.
struct KernelRows {
  int rows, count;  ///< so many columns; rows * count is at most kRowsPixels
  double half_columns, pitch, pitch_y, lens_x;
  double blur_x, blur_y;  ///< pixels record light that arrives so far beside them, too
  const double* y;        ///< of the middle of each row
  /// The end of each sector: no light comes from farther away than this from the micro-image's
  /// centre.
  double closes[kCutAzimuths + 1];
  double centre_x, centre_y;  ///< of the micro-image
  double field_x, field_y;    ///< unit vector away from the optical axis
  double clear2;              ///< squared distance beyond which pixels have a sector of their own
  /// Beyond each square of a distance from the micro-image's centre [m^2], and for parts of pixels
  /// up to each, the level is one more (WorthLevels).
  double rings[kWorthRings], parts[kWorthRings];
  std::uint64_t key;          ///< of microlens and seed
  std::uint32_t row, column;  ///< of the first pixel
};

inline constexpr int kBeamBins = 64;  ///< of distances from the micro-image's centre
inline constexpr int kRasterSide = 128;
/// The share of the raster's extent that rounding may take: rays are moved to world axes.
inline constexpr double kBeamRounding = 1e-9;

/// The view that pixels behind a microlens have of the region that is lit (PixelBeam,
/// OccupiedRegion): the middle between the region's two planes, and the way from one to the other,
/// are affine in the pixel's place, a[0] + a[1] x + a[2] y [m].
struct KernelBeam {
  double middle_x[3], middle_y[3], axis_x[3], axis_y[3];
  double bins_per_metre;
  /// Radii of the beams' discs in each bin, at most and at least [m].
  const double *radius, *inner;
  double lower_x, lower_y, upper_x, upper_y, scale_x, scale_y;  ///< of the raster
  const double* to_lit;  ///< at least as far is the nearest lit place from each one [m]
  double lit_room;       ///< and at most so much farther [m]
};

/// Tells whether the footprint of a pixel meets anything.
enum PixelVisibility {
  kSeesNone,
  kSeesSomething,
  kNeedsExactTest  ///< longer than wide: its disc is to be tested in parts
};

/// Arrays of what is found, with room for kRowsPixels + kRowLanes: one row after the other.
struct KernelRowPixels {
  double *x, *y;            ///< of the pixel's centre
  std::uint64_t* place;     ///< column << 32 | row
  double *x_low, *x_width;  ///< columns that get light; a width not above 0: none
  double* far2;             ///< squared: no point is farther from the micro-image's centre
  int* level;               ///< by worth
  int* sector;              ///< of the cuts (PixelCuts)
  int* visibility;          ///< by the beam (PixelVisibility), of pixels that get light
  std::uint64_t* random[kRowWords];
};

#define PLENOFLAME_PIXEL_ROW_KERNELS                           \
  void set_up_rows(const KernelRows&, const KernelRowPixels&); \
  void cull_pixels(const KernelRows&, const KernelBeam&, const KernelRowPixels&);

namespace baseline {
PLENOFLAME_PIXEL_ROW_KERNELS
}
namespace avx2 {
PLENOFLAME_PIXEL_ROW_KERNELS
}
namespace avx512 {
PLENOFLAME_PIXEL_ROW_KERNELS
}

}  // namespace plenoflame
