#pragma once
#include "plenoflame/film/film.h"
#include "plenoflame/render/render.h"

namespace plenoflame {

/// Runs the backward estimator until the settings are met. With a fixed number of samples it makes
/// one run over all tiles. With a target error or a time limit it makes rounds of growing size. It
/// continues from the content of `film`. Sets statistics.complete, target_reached and
/// relative_error.
/// @param most_points largest number of points of each replicate in one pass, or in one tile of a
/// pass. It limits the memory of the pools. They take 33 MB for 2048 points of two replicates, and
/// twice as much with surfaces.
void render_rounds(const CompiledScene& scene, const RenderSettings& settings,
                   const Execution& execution, Film& film, RenderStatistics& statistics,
                   int most_points = 2048);

}  // namespace plenoflame
