#pragma once
#include <functional>
#include <vector>

#include "plenoflame/render/render.h"
#include "plenoflame/scene/timeline.h"

namespace plenoflame {

/// Compiles a scene of one moment; the result is wanted until the next call.
using MomentCompiler = std::function<const CompiledScene&(const Scene&)>;

/// The figures of an exposure of several moments that is under way.
struct ExposureProgress {
  int pass = 0;          ///< from 0: a target error may take several over all moments
  double target = 0;     ///< error of each moment in this pass; 0: a number of samples
  std::size_t done = 0;  ///< moments that this pass has
  double samples = 0;    ///< of these, added up
  bool reached = true;   ///< all of these met the target
  bool complete = true;  ///< no part of these lacks rays
  double seconds = 0;    ///< that the moment in progress has taken

  friend bool operator==(const ExposureProgress&, const ExposureProgress&) = default;
};

/// An exposure that was stopped, to go on with as if there had been no break.
struct ExposureState {
  ExposureProgress progress;
  /// Sums over the moments that are done: for each channel that of share x flux [W], and with
  /// standard errors, behind all of these, for each channel the variance [W^2]. One replicate.
  Film sums;
  /// The film with which each moment is gone on; without a window: none. With a target these are
  /// of this pass up to the moment in progress, of the pass before behind it.
  std::vector<Film> films;
};

/// Ways to keep the state of an exposure of several moments, and to go on with it.
struct ExposureKeeping {
  /// Called as RenderSettings::checkpoint is, between moments too, and when the run is stopped.
  /// @param current stands for the film of the moment in progress in `state.films`
  std::function<void(const ExposureState& state, const Film& current)> keep = {};
  /// A state of the same moments and settings, but for a time limit. nullptr: from the beginning.
  const ExposureState* resume = nullptr;
};

/// Renders an exposure during which flames change: the mean of what its moments are, each by its
/// share of the time. Fluxes stay in W. A single moment is rendered as render() does, with the same
/// bits.
///
/// Several moments have seeds of their own, so that their errors are independent and the variance
/// of the mean is the sum of share^2 times theirs. Each gets its share of the samples, and of a
/// time limit; a target error is that of the mean. No film is kept of several (RenderResult::film
/// is empty), and RenderSettings::checkpoint and resume are those of a single one: several have
/// `keeping`. "exposure.moments" of the light field's numbers says how many there were. Stopped
/// through execution.stop among several it returns a light field without channels, marked
/// incomplete.
/// @param moments at least one; shares sum to 1 (SceneTimeline::exposure())
/// @throws UsageError for a state of another number of moments, another window or other channels
RenderResult render_exposure(const std::vector<SceneMoment>& moments, const MomentCompiler& compile,
                             const RenderSettings& settings, const Execution& execution = {},
                             const ExposureKeeping& keeping = {});

}  // namespace plenoflame
