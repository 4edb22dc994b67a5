#include "reconstruct_verdict.h"

#include <fmt/format.h>

#include "options.h"
#include "readable.h"

namespace plenoflame {
namespace {

/// Above this part of a value its deviation says that hardly anything is known.
constexpr double kHardlyKnown = 0.5;

}  // namespace

MeanDeviations mean_deviations(const FlameEstimate& estimate, const Unknowns& unknowns) {
  double power = 0, hot = 0, emission = 0, temperature = 0, absorption = 0;
  for (std::size_t j = 0; j < estimate.emission.size(); ++j) {
    const double light = unknowns.volume(j) * estimate.emission[j];
    power += light;
    if (!estimate.emission_deviation.empty())
      emission += unknowns.volume(j) * estimate.emission_deviation[j];
    if (estimate.temperature.empty() || !(estimate.temperature[j] > 0)) continue;
    hot += light;
    if (!estimate.temperature_deviation.empty())
      temperature += light * estimate.temperature_deviation[j];
    if (!estimate.absorption_deviation.empty() && estimate.absorption[j] > 0)
      absorption += light * estimate.absorption_deviation[j] / estimate.absorption[j];
  }
  MeanDeviations means;
  if (power > 0 && !estimate.emission_deviation.empty()) means.emission = emission / power;
  if (hot > 0 && !estimate.temperature_deviation.empty()) means.temperature = temperature / hot;
  if (hot > 0 && !estimate.absorption_deviation.empty()) means.absorption = absorption / hot;
  return means;
}

std::string verdict(const ReconstructResult& result, const Unknowns& unknowns,
                    const std::string& kind, std::size_t cameras) {
  if (!result.figures.complete) return "The run was stopped: this is no result yet.";
  const MeanDeviations means = mean_deviations(result.estimate, unknowns);
  if (!means.emission) return "It is not known how far this can be believed: no deviations.";
  const std::string one = kind == "voxels" ? "voxel" : kind == "rings" ? "ring" : "layer";
  std::string text =
      fmt::format("The emission of a {} is known to {}", one, readable_percent(*means.emission));
  if (means.temperature)
    text += fmt::format(", its temperature to {}",
                        readable(*means.temperature, Dimension::temperature));
  if (means.absorption)
    text += fmt::format(", its absorption to {}", readable_percent(*means.absorption));
  text += '.';
  if (cameras == 1 && kind == "voxels")
    text = "One camera cannot tell the depth. " + text +
           " Rings need one camera where the flame is round; voxels need several.";
  else if (*means.emission > kHardlyKnown)
    text += " That is hardly anything: take more light, more cameras or a coarser grid.";
  return text;
}

}  // namespace plenoflame
