#pragma once
#include <functional>
#include <vector>

#include "plenoflame/render/render.h"
#include "plenoflame/scene/timeline.h"

namespace plenoflame {

/// Compiles a scene of one moment; the result is wanted until the next call.
using MomentCompiler = std::function<const CompiledScene&(const Scene&)>;

/// Renders an exposure during which flames change: the mean of what its moments are, each by its
/// share of the time. Fluxes stay in W. A single moment is rendered as render() does, with the same
/// bits.
///
/// Several moments have seeds of their own, so that their errors are independent and the variance
/// of the mean is the sum of share^2 times theirs. Each gets its share of the samples, and of a
/// time limit; a target error is that of the mean. No film is kept of several (RenderResult::film
/// is empty, RenderSettings::checkpoint and resume are not used), and "exposure.moments" of the
/// light field's numbers says how many there were. Stopped through execution.stop among several it
/// returns a light field without channels, marked incomplete.
/// @param moments at least one; shares sum to 1 (SceneTimeline::exposure())
RenderResult render_exposure(const std::vector<SceneMoment>& moments, const MomentCompiler& compile,
                             const RenderSettings& settings, const Execution& execution = {});

}  // namespace plenoflame
