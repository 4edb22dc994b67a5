#pragma once
#include <optional>
#include <string>
#include <vector>

#include "plenoflame/camera/camera_merit.h"

namespace plenoflame::cli {

struct OptimizerTask {
  MeritSpec merit;
  bool traced = false;            ///< after the formulas, go on by rays
  std::vector<std::string> vary;  ///< focal, pitch, spacing, aperture, focus
  double bound = 2;               ///< every variable stays within this factor of its start
  MicrolensFreedom freedom = MicrolensFreedom::index;
  MicrolensLimits limits;
  double time_limit = 50;  ///< [s] for the part with rays
  /// The overlap that micro-images may have [pixels]; none: not at all, or, where nothing that is
  /// varied could change it, as far as at the start.
  std::optional<double> overlap;
};

struct OptimizerResult {
  CameraSpec camera;
  double merit = 0;  ///< traced when the task asks for it
  int evaluations = 0;
};

/// Maximises the merit. Constraints: microlenses can be made, the camera can exist, micro-images
/// overlap no more than allowed. First over the whole range by the formulas (controlled random
/// search with a fixed seed), then locally, by rays where asked for (Nelder-Mead on subspaces),
/// both of NLopt. The result is never worse than a start that keeps the constraints.
/// @throws InputError when the start itself is impossible, nothing is to be varied, or no camera
/// within
///         the bounds keeps the constraints
OptimizerResult optimize_camera(const CameraSpec& start, const OptimizerTask& task);

}  // namespace plenoflame::cli
