#pragma once
#include "plenoflame/film/film.h"
#include "plenoflame/render/render.h"

namespace plenoflame {

/// Runs the backward estimator until the settings are met: once over all tiles for a given number
/// of samples, or in rounds of growing size until a target error or a time limit. Continues
/// whatever `film` already holds. Sets statistics.complete, target_reached and relative_error.
/// @param most_points of each replicate that one pass, or one tile within it, gets: bounds the
/// memory of the pools, which take 33 MB for 2048 points of two replicates, with surfaces twice as
/// much
void render_rounds(const CompiledScene& scene, const RenderSettings& settings,
                   const Execution& execution, Film& film, RenderStatistics& statistics,
                   int most_points = 2048);

}  // namespace plenoflame
