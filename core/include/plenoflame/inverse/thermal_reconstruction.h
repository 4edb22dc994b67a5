#pragma once
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/inverse/flame_estimate.h"
#include "plenoflame/inverse/reconstruction.h"
#include "plenoflame/inverse/thermal_model.h"
#include "plenoflame/radiometry/source_function.h"

namespace plenoflame {

/// Pictures of one channel.
struct ThermalPictures {
  int channel = 0;                        ///< of the scenes
  std::vector<Measurement> measurements;  ///< one for each view
  SourceFunction source;
  double absorption_ratio = 1;  ///< its absorption over that of the first of the channels
  /// thermal_parts() of each view; empty: no camera has filters.
  std::vector<std::vector<ThermalPart>> parts = {};
};

struct ThermalInput {
  std::vector<CameraView> views;
  std::vector<ThermalPictures> channels;
  const Unknowns* unknowns = nullptr;
  std::vector<double> absorption = {};  ///< [1/m] in the first channel; empty: it is solved for
  /// Start values, e.g. an earlier result; empty: from linear reconstructions.
  std::vector<double> start_temperature = {}, start_absorption = {};
  /// [W/(m^3 sr)] of the first channel, what the linear reconstructions begin with.
  std::vector<double> start_emission = {};
  std::vector<char> support = {};  ///< as ReconstructionInput's
};

inline constexpr std::size_t kMostChained = 3000;

struct ThermalSettings {
  /// Rays, penalty, strength, probes and memory; the linear reconstructions that it begins
  /// with take the rest of it.
  ReconstructionSettings linear;
  int steps = 15;                                               ///< of Gauss and Newton
  double lowest_temperature = 300, highest_temperature = 4000;  ///< [K] bounds
  double lowest_absorption = 1e-3, highest_absorption = 1e4;    ///< [1/m] bounds
};

struct ThermalReconstruction {
  /// Strength of the linear reconstruction at the start; negative: there was none.
  double linear_strength = -1;
  /// The emission is the first channel's. Temperatures are missing after a stop before the first of
  /// them.
  FlameEstimate estimate;
  /// Diagonals of the resolution matrix, of temperatures and of logarithms of absorptions.
  std::vector<double> resolved_temperature, resolved_absorption;
  /// The figures; pictures are those of all views of the first channel, then of the second, ...
  Reconstruction figures;
};

/// Reconstructs the temperature and, if unknown, the absorption: Gauss and Newton's method with
/// bounds on the renderer's own formulas (thermal_model.h). Linear reconstructions give the start.
/// The penalty acts on temperatures and on the logarithms of absorptions, with the same relative
/// strength.
///
/// Deviations and resolution are those of the linearised problem, by probing. With fewer than
/// kMostChained variables a Markov chain checks them. If it is wider by more than a fifth,
/// deviations are multiplied by the ratio. The strength is that of the largest evidence, on the
/// problem linearised about the latest solution. After a stop the result holds the temperatures of
/// the last step, or the emission of the linear reconstruction. Filters in the pupil count as
/// colours: one channel with parts of two colours determines both quantities.
/// @throws UsageError: absorption is unknown and there is one colour only, which determines just
///         the emission
/// @throws InputError and Cancelled as reconstruct()
ThermalReconstruction reconstruct_thermal(const ThermalInput& input,
                                          const ThermalSettings& settings,
                                          const Execution& execution = {});

/// The temperature at which the emissions of two channels have a ratio, within bounds.
/// @param ratio of the first one's emission to that of the second
/// @param absorption_ratio of the second one's absorption to that of the first
double ratio_temperature(const SourceFunction& first, const SourceFunction& second,
                         double absorption_ratio, double ratio, double lowest, double highest);

}  // namespace plenoflame
