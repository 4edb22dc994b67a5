#pragma once
#include <memory>
#include <vector>

#include "plenoflame/film/film.h"
#include "plenoflame/render/render.h"
#include "plenoflame/sampling/sobol.h"

namespace plenoflame {

/// Adds points [first, first + points) of each replicate's sequence to `film`, for all pixels of its
/// window. Statistics are added up. @return false when it was stopped.
bool render_backward(const CompiledScene& scene, const RenderSettings& settings, std::uint32_t first,
                     int points, const Execution& execution, Film& film,
                     RenderStatistics& statistics);

/// Whether single precision is accurate enough: rounding of a ray over the distance to the medium
/// must stay well below the medium's features.
bool single_precision_suffices(const CompiledScene& scene);

}  // namespace plenoflame
