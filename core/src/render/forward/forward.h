#pragma once
#include "plenoflame/base/execution.h"
#include "plenoflame/film/film.h"
#include "plenoflame/render/render.h"
#include "plenoflame/scene/compile.h"

namespace plenoflame {

/// Forward Monte Carlo: energy bundles leave the flame nearly in proportion to its emission, head
/// into the cone of the camera's front aperture, are attenuated on their way out and traced through
/// main lens and array onto the pixels. Adds sum(weight) to the film, in W times the number of
/// bundles per replicate; bundle `index` belongs to replicate index mod replicates. Shares nothing
/// with the backward estimator but the medium and the lens surfaces.
/// Goes on from what `film` holds: settings.samples bundles, or fewer when a target error or the
/// time limit is reached. The film depends on scene, seed and the number of bundles only, not on
/// the number of threads. Sets statistics.complete and target_reached.
void render_forward(const CompiledScene& scene, const RenderSettings& settings,
                    const Execution& execution, Film& film, RenderStatistics& statistics);

}  // namespace plenoflame
