#pragma once
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "plenoflame/base/report.h"
#include "plenoflame/camera/camera_merit.h"
#include "settings.h"

namespace plenoflame {

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
  std::stop_token stop;
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
///         within the bounds keeps the constraints; Cancelled
OptimizerResult optimize_camera(const CameraSpec& start, const OptimizerTask& task);

/// "index", "radius", else the thickness.
MicrolensFreedom freedom_named(const std::string& word);

/// A request for a better camera, as its callers write it.
struct OptimizeRequest {
  SettingNames names = kOptionNames;
  std::string merit = "resolution", vary = "focal";
  double bound = 2;
  std::string array_range = {}, depths = {}, height = {};
  std::optional<int> types = {};
  std::string free = "index";
  double greatest_index = 2;
  std::optional<double> overlap = {};
  bool paraxial = false;
  double time_limit = 50;  ///< [s]
};
template <>
std::span<const SettingRow<OptimizeRequest>> setting_rows();

/// The better camera, and the figures about it.
struct BetterCamera {
  CameraSpec camera;
  Report report;
};

/// @throws UsageError, InputError, Cancelled
BetterCamera optimize_camera(const OptimizeRequest& request, const CameraSpec& start,
                             const std::stop_token& stop);

}  // namespace plenoflame
