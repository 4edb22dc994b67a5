#include "plenoflame/inverse/row_noise.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "plenoflame/base/error.h"
#include "plenoflame/lightfield/smoothed_error.h"

namespace plenoflame {
namespace {

/// [W] The light of a row that determines the error of its rays. The row alone is a poor measure.
/// If few rays meet the flame, some bright rows look dim by chance. Their errors would be those of
/// dim rows, and their weights thousands of times too large. The light is the mean of row and
/// measured flux, each weighted by the other's variance, which makes it uncorrelated with their
/// difference. If the row exceeds this mean, half of the excess is added. The factor of one half
/// was found by experiment (docs/theory/reconstruction.md). Without it rows of few rays count too
/// much; with all of the excess bright rows count too little.
double light_of_row(double row, double flux, double variance, const RayError& rays) {
  double light = std::max(row, flux);
  constexpr int kSteps = 3;  // the error depends on the light
  for (int step = 0; step < kSteps; ++step) {
    const double of_rays = std::pow(rays.at(light), 2);
    light = std::max(0.0, (variance * row + of_rays * flux) / (variance + of_rays));
  }
  return light + 0.5 * std::max(0.0, row - light);
}

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
  std::vector<std::pair<double, double>> rows;
  double errors = 0, squares = 0;
  for (const auto& [one, other] : halves) {
    const double flux = one + other, away = one - other;
    rows.emplace_back(flux, away);
    result.largest = std::max(result.largest, flux);
    errors += away * away;
    squares += flux * flux;
  }
  for (const auto& [flux, error] : errors_by_brightness(std::move(rows))) {
    result.flux.push_back(flux);
    result.error.push_back(error);
  }
  if (!(result.flux.back() > 0)) return {};
  result.overall = std::sqrt(errors / squares);
  return result;
}

std::vector<double> grid_errors(const LinearOperator& a, const EmissionProblem& problem,
                                std::span<const double> x, const std::vector<char>& solved) {
  constexpr double kShare = 0.01;
  const Unknowns& unknowns = *problem.unknowns;
  try {
    std::vector<double> errors =
        a * errors_of_chords(unknowns, values_at_places(unknowns, x, solved), problem.absorption);
    for (double& error : errors) error *= kShare;
    return errors;
  } catch (const Cancelled&) {
    return {};
  }
}

std::vector<double> row_weights(const MeasuredRows& measured, std::span<const double> explained,
                                const RayError& rays, std::span<const double> grid) {
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
      const double error = rays.at(light_of_row(light, measured.flux[i], variance, rays));
      variance += error * error;
    }
    if (!grid.empty()) variance += grid[i] * grid[i];
    weights[i] = 1 / std::sqrt(variance);
  }
  return weights;
}

double misfit_of(std::span<const double> fluxes, std::span<const double> b,
                 std::span<const double> weights) {
  double sum = 0;
  for (std::size_t i = 0; i < fluxes.size(); ++i)
    if (weights[i] > 0) sum += std::pow(weights[i] * (fluxes[i] - b[i]), 2);
  return sum;
}

}  // namespace plenoflame
