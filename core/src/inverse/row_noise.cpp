#include "plenoflame/inverse/row_noise.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace plenoflame {
namespace {

/// Groups of rows by brightness, and rows in each at least: a mean square of 64 squares of normal
/// numbers is known to sqrt(2 / 64) = 18 %, its root to 9 %.
constexpr std::size_t kGroups = 32, kLeastRows = 64;

}  // namespace

double RayError::at(double row_flux) const {
  if (flux.empty()) return 0;
  if (!(row_flux > flux.front())) return error.front();
  const double proportional = error.back() / flux.back() * row_flux;
  if (flux.size() == 1) return proportional;
  const auto above = std::upper_bound(flux.begin(), flux.end() - 1, row_flux);
  const auto k = static_cast<std::size_t>(above - flux.begin());
  const double share = (row_flux - flux[k - 1]) / (flux[k] - flux[k - 1]);
  const double line = error[k - 1] + share * (error[k] - error[k - 1]);
  return share > 1 ? std::clamp(line, error.back(), proportional) : line;
}

RayError RayError::scaled(double factor) const {
  RayError result = *this;
  for (double& value : result.flux) value *= factor;
  for (double& value : result.error) value *= factor;
  result.largest *= factor;
  return result;
}

RayError ray_error(const EmissionProblem& problem, std::span<const double> x,
                   const Execution& execution) {
  // A row is the sum of both halves, whose difference has the same variance.
  std::vector<std::array<double, 2>> halves = replicate_fluxes(problem, x, execution);
  RayError result;
  std::erase_if(halves, [](const auto& h) { return h[0] == 0 && h[1] == 0; });
  if (halves.empty()) return result;
  std::sort(halves.begin(), halves.end(), [](const auto& a, const auto& b) {
    return std::pair(a[0] + a[1], a[0]) < std::pair(b[0] + b[1], b[0]);
  });
  const std::size_t groups = std::clamp<std::size_t>(halves.size() / kLeastRows, 1, kGroups);
  double errors = 0, squares = 0;
  result.largest = halves.back()[0] + halves.back()[1];
  for (std::size_t g = 0; g < groups; ++g) {
    const std::size_t begin = halves.size() * g / groups, end = halves.size() * (g + 1) / groups;
    double light = 0, variance = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const double flux = halves[i][0] + halves[i][1], away = halves[i][0] - halves[i][1];
      light += flux * flux;
      variance += away * away;
    }
    errors += variance;
    squares += light;
    const auto count = static_cast<double>(end - begin);
    // By the RMS of the fluxes: errors in proportion to them then have the RMS that was found. By
    // their mean those of the brightest group, whose fluxes differ most, are too large.
    const double flux = std::sqrt(light / count);
    if (!result.flux.empty() && !(flux > result.flux.back())) continue;
    result.flux.push_back(flux);
    result.error.push_back(std::sqrt(variance / count));
  }
  if (!(result.flux.back() > 0)) return {};
  result.overall = std::sqrt(errors / squares);
  return result;
}

std::vector<double> row_weights(const MeasuredRows& measured, std::span<const double> explained,
                                const RayError& rays) {
  std::vector<double> weights(measured.flux.size(), 0.0);
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (!(measured.deviation[i] > 0)) continue;
    double variance = measured.deviation[i] * measured.deviation[i];
    if (!explained.empty()) {
      const double light = std::max(explained[i], 0.0), electron = measured.electron[i];
      // No row is known better than one electron of a pixel.
      if (electron > 0)
        variance =
            std::max(variance + electron * (light - measured.counted[i]), electron * electron);
      const double error = rays.at(light);
      variance += error * error;
    }
    weights[i] = 1 / std::sqrt(variance);
  }
  return weights;
}

}  // namespace plenoflame
