#include "plenoflame/volumes/reconstruct_verdict.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "plenoflame/inverse/flame_block.h"
#include "plenoflame/math/readable.h"

namespace plenoflame {
namespace {

/// A value whose deviation is above this share of it is poorly known.
constexpr double kHardlyKnown = 0.5;
/// Shares of light that an uncoated window may take.
constexpr std::pair<double, double> kGlass{0.05, 0.15};

/// "0.51 +- 0.03" in a unit.
std::string amount(const Suspect& suspect, double unit) {
  return fmt::format("{:.2g} +- {:.1g}", std::fabs(suspect.estimate) / unit,
                     suspect.deviation / unit);
}

std::string sentence(const Suspect& suspect, UnknownKind kind, const std::string& camera,
                     std::size_t cameras) {
  const bool more = suspect.estimate > 0;
  switch (suspect.kind) {
    case SuspectKind::exposure: {
      const bool glass = -suspect.estimate > kGlass.first && -suspect.estimate < kGlass.second;
      return fmt::format("{}: {} % {} than the others{}.", camera, amount(suspect, 0.01),
                         more ? "brighter" : "darker",
                         glass ? ", as behind a window that the scene lacks" : "");
    }
    case SuspectKind::stray_light:
      return fmt::format("{}: {} W {} in every row, as of stray light or a wrong dark signal.",
                         camera, amount(suspect, 1), more ? "too much" : "too little");
    case SuspectKind::right:
      if (cameras == 1 && kind != UnknownKind::voxels)
        return fmt::format("The axis is {} mm too far {} in the picture of {}.",
                           amount(suspect, 1e-3), more ? "right" : "left", camera);
      return fmt::format("{}: it stands {} mm farther {} than the scene says, or is turned{}.",
                         camera, amount(suspect, 1e-3), more ? "right" : "left",
                         cameras < 4 ? ", or another camera is" : "");
    case SuspectKind::up:
      return fmt::format("{}: it stands {} mm {} than the scene says, or is tilted.", camera,
                         amount(suspect, 1e-3), more ? "higher" : "lower");
    case SuspectKind::forward:
      return fmt::format("{}: it stands {} mm {} than the scene says, or is focused differently{}.",
                         camera, amount(suspect, 1e-3), more ? "nearer" : "farther",
                         more ? ", or looks through glass some three times as thick" : "");
    case SuspectKind::turn:
      return fmt::format("{}: it is turned about its line of sight by {} deg {}.", camera,
                         amount(suspect, std::numbers::pi / 180),
                         more ? "clockwise" : "counter-clockwise");
    case SuspectKind::focus:
      return fmt::format("{}: it is focused {} % {} than the scene says.", camera,
                         amount(suspect, 0.01), more ? "farther" : "nearer");
    case SuspectKind::absorption:
      return fmt::format("The absorption is {} % {} than was given.", amount(suspect, 0.01),
                         more ? "larger" : "smaller");
  }
  return "";
}

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

std::string verdict(const ReconstructResult& result, const Unknowns& unknowns, UnknownKind kind,
                    const std::vector<std::string>& cameras) {
  std::string corrected;
  for (const std::string& line : what_was_corrected(result, kind, cameras)) corrected += ' ' + line;
  if (!result.figures.complete) return "The run was stopped: this is no result yet." + corrected;
  const MeanDeviations means = mean_deviations(result.estimate, unknowns);
  if (!means.emission)
    return "It is not known how far this can be believed: no deviations." + corrected;
  const std::string_view one = name_of(kind).substr(0, name_of(kind).size() - 1);
  std::string text =
      fmt::format("The emission of a {} is known to {}", one, readable_percent(*means.emission));
  if (means.temperature)
    text += fmt::format(", its temperature to {}",
                        readable(*means.temperature, Dimension::temperature));
  if (means.absorption)
    text += fmt::format(", its absorption to {}", readable_percent(*means.absorption));
  const Reconstruction& figures = result.figures;
  if (figures.explained_by_noise && !figures.coarse)
    text += ". The result explains the pictures within their noise.";
  else
    text += fmt::format(
        ". The pictures differ from the result by {:.3g} times their noise{}; the deviations "
        "contain that.",
        figures.noise_factor, figures.coarse ? ", as the grid is coarse" : "");
  if (cameras.size() == 1 && kind == UnknownKind::voxels)
    text = "One camera cannot tell the depth. " + text +
           " Rings need one camera where the flame is round; voxels need several.";
  else if (*means.emission > kHardlyKnown)
    text += std::string(" The emission is hardly known: take more light, more cameras or a ") +
            (figures.coarse ? "finer" : "coarser") + " grid.";
  text += corrected;
  const std::vector<std::string> wrong = what_is_wrong(result, kind, cameras);
  for (const std::string& line : wrong) text += ' ' + line;
  if (!wrong.empty()) text += " The deviations hold for a right model only.";
  return text;
}

std::vector<std::string> what_was_corrected(const ReconstructResult& result, UnknownKind kind,
                                            const std::vector<std::string>& cameras) {
  std::vector<std::string> lines;
  for (const Suspect& suspect : result.corrections)
    lines.push_back(sentence(suspect, kind, cameras.at(suspect.view), cameras.size()) +
                    " This is corrected.");
  return lines;
}

std::vector<std::string> what_is_wrong(const ReconstructResult& result, UnknownKind kind,
                                       const std::vector<std::string>& cameras) {
  const Reconstruction& figures = result.figures;
  std::vector<std::string> lines;
  for (std::size_t v = 0; v < figures.light_outside.size(); ++v)
    if (figures.light_outside[v] > kLightCut)
      lines.push_back(
          fmt::format("The block cuts the flame: {} of the light of {} passes beside it.",
                      readable_percent(figures.light_outside[v]), cameras.at(v)));
  if (result.uncut_block) {
    if (lines.empty())
      lines.emplace_back("The block may cut the flame: light above noise passes beside it.");
    const auto& [lower, upper] = *result.uncut_block;
    lines.push_back(fmt::format("A block about {} of the size {} holds it.",
                                readable_point(0.5 * (lower + upper)),
                                readable_point(upper - lower)));
  }
  for (const Suspect& suspect : figures.suspects) {
    // The deviations hold an error of the absorption that was stated.
    const bool stated = suspect.kind == SuspectKind::absorption &&
                        std::fabs(suspect.estimate) < 2 * figures.absorption_error;
    if (suspect.named && !stated)
      lines.push_back(sentence(suspect, kind, cameras.at(suspect.view), cameras.size()));
  }
  return lines;
}

}  // namespace plenoflame
