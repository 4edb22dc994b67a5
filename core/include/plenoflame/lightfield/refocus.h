#pragma once
#include <string>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/image/image.h"
#include "plenoflame/image/light_field.h"
#include "plenoflame/lightfield/micro_images.h"

namespace plenoflame {

struct RefocusSettings {
  double depth = 0;     ///< [m] of the object plane in front of the main lens' front vertex
  int width = 0;        ///< pixels of the picture; 0: one per microlens across
  double aperture = 1;  ///< of the synthetic lens, in diameters of the main lens' stop: (0, 1]
  std::string channel;  ///< empty: the first
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

/// @throws InputError when a plane cannot be imaged: behind the camera or inside the focal length
void check_refocus_depth(const Camera& camera, double depth);

}  // namespace plenoflame
