#include "reconstruct/reconstruct_warnings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <vector>

namespace plenoflame {
namespace {

/// True if the misfit fell by more than a percent in the last tenth of the iterations.
bool still_falls(const std::vector<double>& history) {
  if (history.size() < 2) return false;
  const std::size_t tenth = std::max<std::size_t>(1, history.size() / 10);
  return history.back() < 0.99 * history[history.size() - 1 - tenth];
}

/// Reasons beside the model for pictures that are not explained.
std::string what_else_may_be(const Reconstruction& figures, const ReconstructionSettings& settings,
                             const SettingNames& names) {
  if (figures.reason == StopReason::iterations && still_falls(figures.history))
    return "more " + names("iterations") + " may explain more, or ";
  if (settings.strength > 0) return names("strength") + " is too large, or ";
  return "";
}

}  // namespace

void warn_single_camera(const Reconstruction& result, const Unknowns& unknowns, double angle,
                        const SettingNames& names, const Execution& execution, Report& report) {
  if (!(angle > 0)) return;
  const double depth = 1 / (2 * std::tan(angle));
  std::string text = fmt::format(
      "one camera sees the grid within +-{:.3g} deg: depth is resolved {:.3g} times worse than "
      "what is across",
      angle * 180 / std::numbers::pi, depth);
  if (result.resolved_unknowns >= 0)
    text += fmt::format("; {:.0f} of {} unknowns are resolved", result.resolved_unknowns,
                        unknowns.size());
  text += ". Use " + names("unknowns", "rings") + " where the flame is round, or more cameras";
  report.add("warning", text, "warning", text);
  report.add_json("half_angle_rad", angle);
  execution.warn(text);
}

void warn_of(const Reconstruction& figures, const ReconstructionSettings& settings,
             const SettingNames& names, const Execution& execution) {
  if (!figures.stored && settings.form == OperatorForm::automatic)
    execution.warn(fmt::format(
        "the matrix would take {:.3g} MB of the {:.3g} MB that it may ({}): rays are {} "
        "again in each iteration",
        1e-6 * figures.matrix_bytes, 1e-6 * settings.memory, names("memory"),
        figures.drawn ? "more than the machine has memory for, and drawn" : "followed"));
  if (!figures.complete) return;
  constexpr double kLeastAccepted = 0.2, kMostOfIt = 0.5;
  if (!figures.explained_by_noise)
    execution.warn(fmt::format(
        "noise does not explain the pictures, chi^2 per row stays at {:.3g}: {}{}",
        figures.chi_squared, what_else_may_be(figures, settings, names),
        figures.grid_share > kMostOfIt
            ? fmt::format("a finer grid explains {:.0f} % of the rest", 100 * figures.grid_share)
            : "the model is wrong by more than that (grid, scene, absorption)"));
  else if (figures.coarse)
    execution.warn(fmt::format(
        "the grid is coarse: without its errors, chi^2 per row is {:.3g}; a finer {} shows more",
        figures.noise_chi_squared, names("grid")));
  else if (figures.strength_at_end)
    execution.warn(std::string("the strength is at the end of the range that was looked at: ") +
                   (figures.trials.empty() ? "" : "see the curve in the report, or ") + "give " +
                   names("strength"));
  if (figures.chain && figures.chain->accepted < kLeastAccepted)
    execution.warn(
        fmt::format("the temperature is known so badly that its deviations are rough: a "
                    "Markov chain takes {:.0f} % of its steps",
                    100 * figures.chain->accepted));
  // Small cameras whose rows erred by 10 % had a scatter of 1.4 to 2 stated deviations.
  constexpr double kMostOfRays = 0.05;
  if (figures.rays_error.overall > kMostOfRays)
    execution.warn(
        fmt::format("the rays err by {:.2g} % of a row: the light that is found is too little, and "
                    "its stated deviations are lower bounds; follow more {}",
                    100 * figures.rays_error.overall, names("rays")));
}

}  // namespace plenoflame
