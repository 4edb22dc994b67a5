#include "plenoflame/inverse/flame_estimate.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "plenoflame/inverse/measurement.h"

namespace plenoflame {

namespace {

/// Calls use(neighbour) for what is next to an unknown along axes and diagonals of the lattice.
template <class Use>
void for_neighbours(const std::array<int, 3>& shape, std::size_t unknown, const Use& use) {
  const auto n1 = static_cast<std::size_t>(shape[1]), n2 = static_cast<std::size_t>(shape[2]);
  const std::array<int, 3> at{static_cast<int>(unknown / (n1 * n2)),
                              static_cast<int>(unknown / n2 % n1), static_cast<int>(unknown % n2)};
  for (int i = std::max(at[0] - 1, 0); i <= std::min(at[0] + 1, shape[0] - 1); ++i)
    for (int j = std::max(at[1] - 1, 0); j <= std::min(at[1] + 1, shape[1] - 1); ++j)
      for (int k = std::max(at[2] - 1, 0); k <= std::min(at[2] + 1, shape[2] - 1); ++k) {
        const std::size_t other =
            (static_cast<std::size_t>(i) * n1 + static_cast<std::size_t>(j)) * n2 +
            static_cast<std::size_t>(k);
        if (other != unknown) use(other);
      }
}

}  // namespace

double temperature_deviation(double temperature, double deviation, const SourceFunction& source) {
  const double value = source(temperature);
  return std::max(std::min(deviation, value) / source_slope(source, temperature),
                  temperature_of(source, value + deviation) - temperature);
}

double absorption_deviation(double absorption, double deviation) {
  constexpr double kInterval = 1.96, kMost = 5;
  return absorption * std::sinh(kInterval * std::min(deviation, kMost)) / kInterval;
}

FlameEstimate estimate_flame(const Reconstruction& reconstruction, const Unknowns& unknowns,
                             const std::vector<double>& absorption, const SourceFunction& source,
                             double threshold) {
  FlameEstimate estimate;
  estimate.emission = reconstruction.at_places;
  estimate.emission_deviation = reconstruction.deviation;
  if (reconstruction.model == RowModel::emission) return estimate;
  const std::size_t n = reconstruction.at_places.size();
  estimate.absorption = absorption;
  // The source function's deviation. Let the absorption be larger by the share e. The true emission
  // is then kappa (1 + e) (S - shift), and the found one errs by kappa (shift - e S).
  std::vector<double> deviation = reconstruction.deviation;
  for (std::size_t j = 0; j < n; ++j) {
    double shift = 0;
    if (!deviation.empty() && !reconstruction.absorption_shift.empty()) {
      shift = reconstruction.absorption_shift[j];
      deviation[j] = std::hypot(deviation[j], shift);
      shift -= reconstruction.absorption_error * estimate.emission[j];
    }
    estimate.emission[j] *= absorption[j];
    if (!deviation.empty())
      estimate.emission_deviation[j] =
          absorption[j] * std::hypot(estimate.emission_deviation[j], shift);
  }
  estimate.temperature.assign(n, 0.0);
  estimate.decided.assign(n, 0);
  if (!deviation.empty()) estimate.temperature_deviation.assign(n, 0.0);
  double largest = 0;
  for (std::size_t j = 0; j < n; ++j)
    if (absorption[j] > 0) largest = std::max(largest, reconstruction.at_places[j]);
  for (std::size_t j = 0; j < n; ++j) {
    const double value = reconstruction.at_places[j];
    if (!(absorption[j] > 0) || !(value > threshold * largest)) continue;
    const double t = temperature_of(source, value);
    if (t < kAmbient) continue;
    estimate.decided[j] = 1;
    estimate.temperature[j] = t;
    if (!deviation.empty())
      estimate.temperature_deviation[j] = temperature_deviation(t, deviation[j], source);
  }
  for (std::size_t j = 0; j < n; ++j) {
    if (estimate.decided[j] || !(absorption[j] > 0)) continue;
    double weight = 0, sum = 0;
    for_neighbours(unknowns.shape(), j, [&](std::size_t other) {
      if (!estimate.decided[other]) return;
      weight += estimate.emission[other];
      sum += estimate.emission[other] * estimate.temperature[other];
    });
    if (!(weight > 0)) continue;
    estimate.temperature[j] = sum / weight;
    estimate.absorption[j] = estimate.emission[j] / source(estimate.temperature[j]);
  }
  return estimate;
}

void add_deviation(std::span<const double> moved, const SourceFunction& source,
                   FlameEstimate& estimate) {
  for (std::size_t j = 0; j < estimate.temperature_deviation.size(); ++j) {
    double &emission = estimate.emission_deviation[j],
           &temperature = estimate.temperature_deviation[j];
    emission = std::hypot(emission, estimate.absorption[j] * moved[j]);
    if (temperature > 0)
      temperature = std::hypot(
          temperature, temperature_deviation(estimate.temperature[j], std::fabs(moved[j]), source));
  }
}

EstimateErrors compare_estimate(const FlameEstimate& estimate, const std::vector<double>& emission,
                                const std::vector<double>& temperature,
                                const std::vector<double>& volumes,
                                const std::vector<double>& absorption) {
  EstimateErrors errors;
  double away = 0, all = 0, away_t = 0, weight_t = 0, away_k = 0, weight_k = 0;
  for (std::size_t j = 0; j < emission.size(); ++j) {
    const double d = estimate.emission[j] - emission[j];
    away += volumes[j] * d * d;
    all += volumes[j] * emission[j] * emission[j];
    errors.largest_truth = std::max(errors.largest_truth, emission[j]);
    if (!absorption.empty() && !estimate.absorption.empty() && absorption[j] > 0) {
      const double weight = volumes[j] * emission[j];
      away_k += weight * std::fabs(estimate.absorption[j] / absorption[j] - 1);
      weight_k += weight;
    }
    if (temperature.empty() || estimate.temperature.empty() || !(temperature[j] > 0)) continue;
    const double weight = volumes[j] * emission[j];
    away_t += weight * std::fabs(estimate.temperature[j] / temperature[j] - 1);
    weight_t += weight;
  }
  errors.emission = all > 0 ? std::sqrt(away / all) : 0;
  errors.absorption = weight_k > 0 ? away_k / weight_k : 0;
  errors.temperature = weight_t > 0 ? away_t / weight_t : 0;
  return errors;
}

}  // namespace plenoflame
