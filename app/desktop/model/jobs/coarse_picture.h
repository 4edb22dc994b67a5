#pragma once
#include <memory>

#include "plenoflame/image/light_field.h"
#include "plenoflame/scene/compile.h"

namespace plenoflame::desktop {

/// A light field of the scene's whole sensor without its pixels: names, estimator, scene.
std::shared_ptr<LightField> empty_picture(const CompiledScene& scene);

/// A picture of the whole sensor within a fraction of a second, from few large pixels in the place
/// of many: each pixel gets its share of the flux of the large one that it lies in. It has no
/// standard errors, and does not count as complete.
/// @return null where the sensor is so small that nothing would be gained, or its pixels cannot be
///         gathered (forward estimator)
/// @throws Cancelled
std::shared_ptr<LightField> coarse_picture(const CompiledScene& scene, const Execution& execution);

/// The large pixel of a row (or column) of `whole` pixels that pixel `at` lies in, where `coarse`
/// of `factor` pixels each share their middle.
int coarse_pixel(int at, int whole, int coarse, int factor);

}  // namespace plenoflame::desktop
