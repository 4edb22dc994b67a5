#pragma once
#include <memory>
#include <optional>

#include "plenoflame/image/light_field.h"
#include "plenoflame/scene/compile.h"

namespace plenoflame::desktop {

/// A light field of the scene's whole sensor without its pixels: names, estimator, scene.
std::shared_ptr<LightField> empty_picture(const CompiledScene& scene);

/// The part of a coarse picture that the next one reuses if only flames have changed: its camera of
/// large pixels. The camera's pupils take longer to trace than its rays.
struct CoarseScene {
  std::optional<CompiledScene> compiled;
};

/// A picture of the whole sensor within a fraction of a second, from a few large pixels. Each pixel
/// gets its share of the flux of its large pixel. The picture has no standard errors, and does not
/// count as complete.
/// @param kept of the picture before; becomes this one's. The picture has the same bits without it
/// @return null if the sensor is too small to gain time, or its pixels cannot be gathered (forward
///         estimator)
/// @throws Cancelled
std::shared_ptr<LightField> coarse_picture(const CompiledScene& scene, const Execution& execution,
                                           CoarseScene& kept);

/// The large pixel of a row (or column) of `whole` pixels that pixel `at` lies in, where `coarse`
/// of `factor` pixels each share their middle.
int coarse_pixel(int at, int whole, int coarse, int factor);

}  // namespace plenoflame::desktop
