#pragma once
#include <functional>
#include <vector>

#include "plenoflame/render/render.h"
#include "plenoflame/scene/timeline.h"

namespace plenoflame {

/// Compiles the scene of one moment; the result stays valid until the next call.
using MomentCompiler = std::function<const CompiledScene&(const Scene&)>;

/// The state of an exposure of several moments during rendering.
struct ExposureProgress {
  int pass = 0;          ///< from 0; a target error may need several passes over all moments
  double target = 0;     ///< error of each moment in this pass; 0: fixed number of samples
  std::size_t done = 0;  ///< moments that this pass has completed
  double samples = 0;    ///< sum over these moments
  bool reached = true;   ///< all of these moments met the target
  bool complete = true;  ///< all parts of these moments have their rays
  double seconds = 0;    ///< time spent on the moment in progress

  friend bool operator==(const ExposureProgress&, const ExposureProgress&) = default;
};

/// The state of a stopped exposure. It continues from here with the same result as without a stop.
struct ExposureState {
  ExposureProgress progress;
  /// Sums over the completed moments, in one replicate: for each channel the sum of share x flux
  /// [W]. With standard errors, the variances [W^2] of all channels follow.
  Film sums;
  /// The film with which each moment continues; without a window: none. With a target, films up to
  /// the moment in progress belong to this pass, later ones to the previous pass.
  std::vector<Film> films;
};

/// How the state of an exposure of several moments is saved and resumed.
struct ExposureKeeping {
  /// Called like RenderSettings::checkpoint, between moments too, and when the run is stopped.
  /// @param current replaces the film of the moment in progress in `state.films`
  std::function<void(const ExposureState& state, const Film& current)> keep = {};
  /// A state with the same moments and settings; the time limit may differ. nullptr: start anew.
  const ExposureState* resume = nullptr;
};

/// Renders an exposure during which flames change: the mean of its moments, each weighted by its
/// share of the time. Fluxes stay in W. A single moment gives the same bits as render().
///
/// Several moments use different seeds. Their errors are therefore independent, and the variance of
/// the mean is the sum of share^2 times their variances. Each moment gets its share of the samples
/// and of a time limit. A target error applies to the mean.
///
/// With several moments no film is kept (RenderResult::film is empty). `keeping` then replaces
/// RenderSettings::checkpoint and resume. "exposure.moments" in the light field's numbers is the
/// number of moments. If execution.stop ends the run among several moments, the light field has no
/// channels and is marked incomplete.
/// @param moments at least one; shares sum to 1 (SceneTimeline::exposure())
/// @throws UsageError for a state with another number of moments, another window or other channels
RenderResult render_exposure(const std::vector<SceneMoment>& moments, const MomentCompiler& compile,
                             const RenderSettings& settings, const Execution& execution = {},
                             const ExposureKeeping& keeping = {});

}  // namespace plenoflame
