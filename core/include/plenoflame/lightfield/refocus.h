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

/// The picture of a lens that is focused on the plane at this depth: every raw pixel is carried
/// along its chief ray (MicroImages) to the plane and spread there over the pixels that it meets,
/// light and white light apart; their ratio is the picture. It needs no focal plane of the array,
/// so that focused and unfocused cameras are treated alike. Pixels between the samples, where the
/// samples lie farther apart than the picture's pixels, are filled from coarser levels.
/// The result does not depend on the number of threads.
/// @throws InputError: depth not beyond the front focal plane, settings out of range, unknown
/// channel,
///         pixels that are not finite
RefocusedImage refocus(const LightField& light_field, const MicroImages& micro_images,
                       const RefocusSettings& settings, const Execution& execution = {});

/// The weight of each type of microlens at a depth: 1 when its blur is at most a pixel of the
/// sensor, or what a pixel of the picture takes up on the sensor, or as small as any type's;
/// falling with the fourth power of the blur beyond. In a coarse picture all types count, since the
/// more there are the more evenly their samples lie. Blur as in depth_of_field() (camera/design.h),
/// from first-order optics.
/// @param pixel [m] side of a pixel of the picture on the plane at `depth`
std::vector<double> type_weights(const Camera& camera, double depth, double pixel);

/// Pictures at several depths and what can be told from them together. All have the same size, and
/// a pixel stands for the same direction (that of the same microlens) in each of them.
struct FocusStack {
  std::vector<RefocusedImage> planes;
  /// Per pixel the plane on which its samples, seen from different places of the main lens, agree
  /// best: least variance of the samples' radiance over the square of its mean, both over 5 x 5
  /// pixels. A place that has less than some hundredths of the stack's brightest one in a plane is
  /// dark there, and evenly so.
  Image all_in_focus;  ///< radiance there [W/(m^2 sr)]
  /// [m] between the planes by a parabola through the variances of three; for opaque scenes: a
  /// flame is transparent and has no single depth. 0 where nothing was seen.
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
