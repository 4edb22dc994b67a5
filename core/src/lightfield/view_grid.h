#pragma once
#include "lightfield/view_resampling.h"
#include "plenoflame/lightfield/micro_images.h"
#include "plenoflame/lightfield/views.h"

namespace plenoflame {

struct OutputGrid {
  int width = 0, height = 0;
  Vec2 first;       ///< [m] array point of pixel (0, 0)
  double step = 0;  ///< [m]
};

/// Square pixels that cover the window, one of them centred on the array's offset: a square array
/// that is not turned then needs no interpolation.
/// @throws InputError for a window without a micro-image
OutputGrid output_grid(const MicroImages& micro, const ArraySpec& array, const PixelWindow& window);

/// The lattice of the lenses of one type. With three types in a hexagonal array (type (q - r) mod
/// 3) it is hexagonal again, turned by 30 degrees. In other arrays lenses of other types are left
/// out.
struct TypeLattice {
  ArraySpec array;
  bool coarse = false;
  int type = -1;
  TypeLattice(const Camera& camera, int of_type);
  /// Its index there; only for lenses of the type.
  LensIndex index(LensIndex lens) const;
  /// The camera's lenses of the type about the grid's pixels.
  std::vector<LensIndex> lenses(const Camera& camera, const OutputGrid& grid) const;
};

/// A picture of the samples, upright; 0 where nothing is known.
/// @throws InputError for a value that is not finite
Image resampled(const LensSamples& samples, const OutputGrid& grid, ViewResampling resampling);

}  // namespace plenoflame
