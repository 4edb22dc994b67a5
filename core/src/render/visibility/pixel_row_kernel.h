// Data of rows of pixels behind a microlens, before rays are drawn, for every instruction set.
#pragma once
#include <cstdint>

#include "plenoflame/camera/cut_kernel.h"

namespace plenoflame {

inline constexpr int kRowsPixels = 256;  ///< largest number of pixels in one call
inline constexpr int kRowLanes = 8;      ///< pixels in a vector
inline constexpr int kWorthRings = 6;
/// Random words for each pixel. The first one depends on pixel and microlens, and the others on its
/// four successors. Each further use of the first word adds its own constant, far from these, so
/// that the sequences stay independent.
inline constexpr int kRowWords = 5;

/// Rows of pixels; all lengths from the microlens' centre [m]. A pixel is at x = (half_columns -
/// (column + 1/2)) pitch - lens_x.
struct KernelRows {
  int rows, count;  ///< count: number of columns; rows * count is at most kRowsPixels
  double half_columns, pitch, pitch_y, lens_x;
  double blur_x, blur_y;  ///< distance beside a pixel from which it records light
  const double* y;        ///< y of the middle of each row
  /// The end of each sector: the largest distance from the micro-image's centre with light.
  double closes[kCutAzimuths + 1];
  double centre_x, centre_y;  ///< centre of the micro-image
  double field_x, field_y;    ///< unit vector away from the optical axis
  double clear2;              ///< squared distance beyond which pixels have a sector
  /// A pixel's level rises by one at each of these squared distances from the centre of the
  /// micro-image [m^2]. It also rises by one for lit parts of the pixel up to each of `parts`
  /// (WorthLevels).
  double rings[kWorthRings], parts[kWorthRings];
  std::uint64_t key;          ///< random key of microlens and seed
  std::uint32_t row, column;  ///< of the first pixel
};

/// Arrays of results, with room for kRowsPixels + kRowLanes: one row after the other.
struct KernelRowPixels {
  double *x, *y;            ///< of the pixel's centre
  std::uint64_t* place;     ///< column << 32 | row
  double *x_low, *x_width;  ///< lit columns; none if the width is not positive
  double* far2;             ///< squared largest distance to the micro-image's centre
  int* level;               ///< by worth
  int* sector;              ///< of the cuts (PixelCuts)
  std::uint64_t* random[kRowWords];
};

#define PLENOFLAME_PIXEL_ROW_KERNELS void set_up_rows(const KernelRows&, const KernelRowPixels&);

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
