#pragma once
#include <string>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/image/image.h"
#include "plenoflame/image/light_field.h"
#include "plenoflame/lightfield/micro_images.h"

namespace plenoflame {

/// Ways in which one sample per microlens becomes a picture with square pixels.
enum class ViewResampling {
  nearest,      ///< the sample of the nearest microlens
  barycentric,  ///< linear over the triangles of a hexagonal array, bilinear over a square one
  paper9,       ///< the paper's Eq. (9), hexagonal arrays only
  paper10,      ///< the paper's Eq. (10), hexagonal arrays only
};

struct ViewSettings {
  int grid = 7;  ///< views along each side
  /// Side of the square over which the views' middles are spread, in diameters of the stop's image;
  /// up to 0.7 all of them lie inside.
  double spread = 0.7;
  ViewResampling resampling = ViewResampling::barycentric;
  /// true: divided by the light that a uniform scene would give, so that values are radiances
  /// [W/(m^2 sr)]; false: as recorded, flux per pixel [W].
  bool white_correction = true;
  /// Microlenses of this type alone, 0 based; -1: all. The lattice of one type of three is coarser
  /// by the square root of 3, and so is the picture.
  int type = -1;
  std::string channel;  ///< empty: the first
};

/// The scene as it looks from one place on the main lens.
struct View {
  int column = 0, row = 0;  ///< in the grid: to the right and down as the place on the main lens
  Vec2 offset;              ///< [pixel] from the micro-images' centres, upright: x right, y down
  Image image;              ///< upright; 0 where nothing is known
};

struct Views {
  std::vector<View> views;  ///< row by row
  double lens_step = 0;     ///< [m] on the array between neighbouring pixels of a view
  std::string unit;         ///< "W/(m^2 sr)" or "W"
};

/// Sub-aperture views. Each view belongs to one place on the main lens and has one sample per
/// microlens, at the same offset from the micro-image's centre. Samples are interpolated bilinearly
/// between pixels and then resampled to square pixels with the area of one microlens. White
/// correction divides interpolated light by interpolated white light, so that a uniform scene stays
/// uniform up to the rim of the micro-images. A sample counts as unknown if its white light is
/// below kLeastWhite of the axis' white light.
/// @throws InputError: unknown channel, settings out of range, a kernel that does not suit the
///         lattice, offsets beyond the light, pixels that are not finite
Views extract_views(const LightField& light_field, const MicroImages& micro_images,
                    const ViewSettings& settings, const Execution& execution = {});

inline constexpr double kLeastWhite = 0.1;

/// Epipolar slice: one line of the scene as the viewpoint moves. Row v of the slice is row `line`
/// of view v along the middle row of the grid. If vertical, it is column `line`, from top to
/// bottom, of view v along the middle column. Objects at one depth draw straight lines, whose slope
/// is their disparity.
/// @throws InputError for a line outside of the views
Image epipolar_slice(const Views& views, int line, bool vertical);

/// All views side by side in their grid, one dark pixel between.
Image contact_sheet(const Views& views);

}  // namespace plenoflame
