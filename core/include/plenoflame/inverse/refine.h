#pragma once
#include <memory>
#include <span>
#include <vector>

#include "plenoflame/inverse/reconstruction.h"

namespace plenoflame {

/// Quantities of cameras that were found together with the flame.
struct Refinement {
  /// Amount by which each quantity is larger than in the scenes, with its standard deviation.
  std::vector<Suspect> corrections;
  /// The scene of each view with its quantities corrected, and without flames; null: nothing was.
  std::vector<std::shared_ptr<const CompiledScene>> scenes;
  std::vector<double> exposures;  ///< of each view, by which its pictures are divided
  bool settled = true;            ///< false: the last round still moved by half a deviation
};

/// Gauss and Newton's method on the variable projection. Each round finds the flame, tests the
/// model (suspect.h), and corrects the named quantities. Later rounds estimate all corrected ones
/// together.
/// @param input must outlive the call only @param kinds those that may be corrected; stray light
/// may not @throws as reconstruct(); Cancelled
Refinement refine_cameras(const ReconstructionInput& input, ReconstructionSettings settings,
                          std::span<const SuspectKind> kinds, const Execution& execution);

/// Divides fluxes, their deviations and their electrons by a camera's exposure.
void correct_exposure(Measurement& measurement, double exposure);

}  // namespace plenoflame
