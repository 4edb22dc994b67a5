#pragma once
#include "plenoflame/film/film.h"
#include "plenoflame/render/render.h"

namespace plenoflame {

/// Runs the backward estimator until the settings are met: once over all tiles for a given number
/// of samples, or in rounds of growing size until a target error or a time limit. Continues
/// whatever `film` already holds. Sets statistics.complete, target_reached and relative_error.
void render_rounds(const CompiledScene& scene, const RenderSettings& settings,
                   const Execution& execution, Film& film, RenderStatistics& statistics);

}  // namespace plenoflame
