#pragma once
#include "plenoflame/render/render.h"

namespace plenoflame {

/// Statistics before any work is done.
void begin_statistics(const CompiledScene& scene, const RenderSettings& settings,
                      const Execution& execution, RenderStatistics& statistics);

/// Makes the light field of a film, with its statistics and warnings. If statistics.complete is
/// set, the images are taken out of the film.
void finish_picture(const CompiledScene& scene, const RenderSettings& settings,
                    const Execution& execution, RenderResult& result);

}  // namespace plenoflame
