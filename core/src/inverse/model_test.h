#pragma once
#include <functional>
#include <span>
#include <vector>

#include "inverse/operators/scaled_problem.h"
#include "plenoflame/inverse/emission_operator.h"
#include "plenoflame/inverse/reconstruction.h"
#include "plenoflame/inverse/uncertainty.h"

namespace plenoflame {

/// A solved problem whose model is tested.
struct TestedModel {
  const EmissionProblem* emission = nullptr;
  const std::vector<CameraView>* views = nullptr;  ///< with their windows
  const ScaledProblem* problem = nullptr;
  CameraRaySettings rays;            ///< by which A's were drawn
  std::span<const double> light;     ///< A x
  std::span<const double> residual;  ///< b - A x
  bool absorption = true;            ///< is tested, where it is known
  /// Quantities that were corrected: what is left of them is estimated with those that are named.
  std::span<const Suspect> corrected;
  /// Quantities that were corrected before, and what takes the change of all rows for each of them
  /// that is larger by its deviation.
  std::span<const Suspect> refined;
  std::function<void(std::span<const double> change)> keep;
};

struct TestOfModel {
  std::vector<Suspect> suspects;  ///< those first that the pictures name
  double grid_share = 0;          ///< as in Reconstruction
};

/// Tests the absorption, and exposure, stray light, place, rotation and focus of each camera
/// against the pictures. The flame is free to follow, also between the unknowns
/// (docs/theory/reconstruction.md). Quantities
/// that explain the misfit are named, one after the other, until no other is significant. Only
/// several cameras determine exposures. Cameras that cannot be displaced are not.
/// @param accuracy of one solution for each quantity
/// @param execution whose progress goes from 0 to 1
/// @throws Cancelled
TestOfModel test_model(const TestedModel& model, const Reconstruction& found,
                       const ProbeAccuracy& accuracy, const Execution& execution);

}  // namespace plenoflame
