#pragma once
#include <optional>
#include <string>
#include <vector>

#include "plenoflame/camera/camera_merit.h"

namespace plenoflame::cli {

struct OptimizerTask {
  MeritSpec merit;
  bool traced = false;            ///< after the formulas, continue by rays
  std::vector<std::string> vary;  ///< focal, pitch, spacing, aperture, focus
  double bound = 2;               ///< every variable stays within this factor of its start
  MicrolensFreedom freedom = MicrolensFreedom::index;
  MicrolensLimits limits;
  double time_limit = 50;  ///< [s] for the part with rays
  /// The overlap that micro-images may have [pixels]. Without value: none, or that of the start if
  /// no varied property can change it.
  std::optional<double> overlap;
};

struct OptimizerResult {
  CameraSpec camera;
  double merit = 0;  ///< traced if the task is
  int evaluations = 0;
};

/// Maximises the merit. Constraints: microlenses can be made, the camera can exist, micro-images
/// overlap no more than allowed. The first search covers the whole range by the formulas
/// (controlled random search with a fixed seed). The second is local, by rays on request
/// (Nelder-Mead on subspaces). Both are from NLopt. The result is never worse than a start that
/// keeps the constraints.
/// @throws InputError when the start itself is impossible, no variable is given, or no camera
///         within the bounds keeps the constraints
OptimizerResult optimize_camera(const CameraSpec& start, const OptimizerTask& task);

}  // namespace plenoflame::cli
