#pragma once
#include "plenoflame/render/render.h"

namespace plenoflame {

/// Statistics before any work is done.
void begin_statistics(const CompiledScene& scene, const RenderSettings& settings,
                      const Execution& execution, RenderStatistics& statistics);

/// Makes the light field of a film, with what statistics and warnings say of it as a whole. Where
/// statistics.complete the film's pictures are taken.
void finish_picture(const CompiledScene& scene, const RenderSettings& settings,
                    const Execution& execution, RenderResult& result);

}  // namespace plenoflame
