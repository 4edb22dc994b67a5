#pragma once
#include <string>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/base/isa.h"
#include "plenoflame/image/image.h"
#include "plenoflame/image/light_field.h"
#include "plenoflame/lightfield/micro_images.h"

namespace plenoflame {

struct RefocusSettings {
  double depth = 0;     ///< [m] of the object plane in front of the main lens' front vertex
  int width = 0;        ///< pixels of the picture; 0: one per microlens across
  double aperture = 1;  ///< of the synthetic lens, in diameters of the main lens' stop: (0, 1]
  /// Plenoptic 2.0 with several types of microlenses: each counts as it is sharp at this depth
  /// (type_weights); false: all alike.
  bool sharp_types = true;
  std::string channel;  ///< empty: the first
  Isa isa = best_isa();
};

struct RefocusedImage {
  Image image;       ///< radiance [W/(m^2 sr)], upright; 0 where nothing was seen
  double depth = 0;  ///< [m]
  double pixel = 0;  ///< [m] side of a pixel on the object plane
  Vec2 corner;       ///< [m] camera x, y on that plane of the outer corner of pixel (0, 0)
};

/// The picture of a lens that is focused on the plane at this depth. Every raw pixel is carried
/// along its chief ray (MicroImages) to the plane and spread there over the pixels that it meets.
/// Light and white light are summed separately; their ratio is the picture. The method needs no
/// focal plane of the array, so it treats focused and unfocused cameras alike. If samples are
/// sparser than the picture's pixels, the gaps are filled from coarser levels. The result does not
/// depend on the number of threads.
/// @throws InputError: depth not beyond the front focal plane, settings out of range, unknown
///         channel, pixels that are not finite
RefocusedImage refocus(const LightField& light_field, const MicroImages& micro_images,
                       const RefocusSettings& settings, const Execution& execution = {});

/// The weight of each type of microlens at a depth. It is 1 if the type's blur is at most a pixel
/// of the sensor or a picture pixel's size on the sensor. It is also 1 for the type with the
/// smallest blur. Beyond, it falls with the fourth power of the blur. In a coarse picture all types
/// count, because more samples are spread more evenly. Blur as in depth_of_field()
/// (camera/design.h), from first-order optics.
/// @param pixel [m] side of a pixel of the picture on the plane at `depth`
std::vector<double> type_weights(const Camera& camera, double depth, double pixel);

/// Pictures at several depths and what can be told from them together. All have the same size, and
/// a pixel stands for the same direction (that of the same microlens) in each of them.
struct FocusStack {
  std::vector<RefocusedImage> planes;
  /// Per pixel the plane on which its samples, seen from different places of the main lens, agree
  /// best. This is the plane with the least variance of the samples' radiance over the square of
  /// its mean, both over 5 x 5 pixels. A place below some hundredths of the stack's brightest one
  /// counts as dark in that plane, and its samples as equal.
  Image all_in_focus;  ///< radiance there [W/(m^2 sr)]
  /// [m] Interpolated between the planes by a parabola through the variances of three. Only for
  /// opaque scenes: a flame is transparent and has no single depth. 0 where nothing was seen.
  Image depth;
  /// 0: all depths fit alike (no texture); towards 1: one fits much better than the mean does.
  Image confidence;
};

/// @param depths [m] ascending, at least 3
/// @throws InputError as refocus, and for depths that do not ascend
FocusStack focus_stack(const LightField& light_field, const MicroImages& micro_images,
                       const std::vector<double>& depths, const RefocusSettings& settings,
                       const Execution& execution = {});

/// @throws InputError when a plane cannot be imaged: behind the camera or inside the focal length
void check_refocus_depth(const Camera& camera, double depth);

}  // namespace plenoflame
