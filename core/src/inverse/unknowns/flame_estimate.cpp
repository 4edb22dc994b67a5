#include "plenoflame/inverse/flame_estimate.h"

#include <algorithm>
#include <cmath>

#include "plenoflame/inverse/measurement.h"

namespace plenoflame {

FlameEstimate estimate_flame(const Reconstruction& reconstruction,
                             const std::vector<double>& absorption, const SourceFunction& source,
                             double threshold) {
  FlameEstimate estimate;
  estimate.emission = reconstruction.values;
  estimate.emission_deviation = reconstruction.deviation;
  if (reconstruction.model == RowModel::emission) return estimate;
  const std::size_t n = reconstruction.values.size();
  estimate.absorption = absorption;
  for (std::size_t j = 0; j < n; ++j) {
    estimate.emission[j] *= absorption[j];
    if (!estimate.emission_deviation.empty()) estimate.emission_deviation[j] *= absorption[j];
  }
  estimate.temperature.assign(n, 0.0);
  if (!reconstruction.deviation.empty()) estimate.temperature_deviation.assign(n, 0.0);
  double largest = 0;
  for (std::size_t j = 0; j < n; ++j)
    if (absorption[j] > 0) largest = std::max(largest, reconstruction.values[j]);
  for (std::size_t j = 0; j < n; ++j) {
    const double value = reconstruction.values[j];
    const double deviation = reconstruction.deviation.empty() ? 0 : reconstruction.deviation[j];
    if (!(absorption[j] > 0) || !(value > threshold * largest) || !(value > 2 * deviation))
      continue;
    const double t = temperature_of(source, value);
    estimate.temperature[j] = t;
    if (deviation > 0) estimate.temperature_deviation[j] = deviation / source_slope(source, t);
  }
  return estimate;
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
