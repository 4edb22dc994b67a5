#pragma once
#include "plenoflame/base/execution.h"
#include "plenoflame/film/film.h"
#include "plenoflame/render/render.h"
#include "plenoflame/scene/compile.h"

namespace plenoflame {

/// Forward Monte Carlo. Energy bundles leave the flame nearly in proportion to its emission, in the
/// cone of the camera's front aperture. They are attenuated on their way out and traced through
/// main lens and array onto the pixels. Adds sum(weight) to the film, in W times the number of
/// bundles per replicate. Bundle `index` belongs to replicate index mod replicates. The code shares
/// only the medium and the lens surfaces with the backward estimator.
///
/// Continues from the content of `film`, up to settings.samples bundles. It uses fewer bundles when
/// a target error or the time limit is reached. The film depends on scene, seed and the number of
/// bundles, and does not depend on the number of threads. Sets statistics.complete and
/// target_reached.
void render_forward(const CompiledScene& scene, const RenderSettings& settings,
                    const Execution& execution, Film& film, RenderStatistics& statistics);

}  // namespace plenoflame
