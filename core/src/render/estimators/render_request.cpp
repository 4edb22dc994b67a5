#include "plenoflame/render/render_request.h"

#include <algorithm>

namespace plenoflame {

RenderSettings render_settings(const Scene& scene, const RenderRequest& request) {
  const RenderSpec& spec = scene.render;
  RenderSettings settings;
  settings.estimator = request.estimator.value_or(spec.estimator);
  settings.target_error = request.target_error.value_or(0);
  settings.time_limit = request.time_limit.value_or(0);
  settings.seed = request.seed.value_or(spec.seed);
  // With a target or a time limit the scene's number of samples is no limit.
  const bool open_ended = request.target_error || request.time_limit;
  settings.samples = request.samples.value_or(open_ended ? kMostSamples : spec.samples);
  if (settings.estimator == Estimator::forward) {
    // A scene for the other estimator does not tell how many bundles are needed.
    const bool scene_says =
        spec.estimator == Estimator::forward && spec.samples != RenderSpec{}.samples;
    if (!request.samples && !scene_says) settings.samples = kForwardSamples;
    if (!request.samples && open_ended) settings.samples = kMostBundles;
    settings.replicates = std::min(kForwardReplicates, settings.samples);
  }
  // A single sample gives no estimate of its error.
  settings.replicates = std::clamp(settings.samples, 1, settings.replicates);
  return settings;
}

}  // namespace plenoflame
