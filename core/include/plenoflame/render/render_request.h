#pragma once
#include <cstdint>
#include <optional>

#include "plenoflame/render/render.h"
#include "plenoflame/scene/scene.h"

namespace plenoflame {

/// Settings of a caller that replace those of the scene. Settings without a value come from the
/// scene.
struct RenderRequest {
  std::optional<Estimator> estimator;
  std::optional<int> samples;          ///< with a target or a time limit: the largest number
  std::optional<double> target_error;  ///< relative, as RenderSettings::target_error
  std::optional<double> time_limit;    ///< [s]
  std::optional<std::uint64_t> seed;
};

/// The settings with which every front end renders a scene: estimator, samples, replicates, target,
/// limit and seed. A number of samples for the other estimator, or for a picture without a target,
/// is no limit.
RenderSettings render_settings(const Scene& scene, const RenderRequest& request = {});

}  // namespace plenoflame
