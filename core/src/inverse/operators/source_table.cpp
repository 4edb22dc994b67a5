#include "inverse/operators/source_table.h"

#include <cmath>
#include <cstddef>

#include "plenoflame/inverse/measurement.h"

namespace plenoflame {
namespace {

constexpr double kLowest = 200, kStep = 1;
constexpr std::size_t kKnots = 5801;

}  // namespace

SourceTable::SourceTable(const SourceFunction& source) : source_(source) {
  knots_.reserve(kKnots);
  for (std::size_t i = 0; i < kKnots; ++i) {
    const double temperature = kLowest + static_cast<double>(i) * kStep;
    const double value = source(temperature);
    const double slope = source_slope(source, temperature);
    if (!(value > 0) || !std::isfinite(std::log(value)) || !std::isfinite(slope / value)) {
      knots_.clear();
      return;
    }
    knots_.push_back({std::log(value), slope / value});
  }
}

SourceTable::Value SourceTable::at(double temperature) const {
  const double place = (temperature - kLowest) / kStep;
  if (knots_.empty() || !(place >= 0) || !(place < static_cast<double>(kKnots - 1)))
    return {source_(temperature), source_slope(source_, temperature)};
  const auto i = static_cast<std::size_t>(place);
  const double t = place - static_cast<double>(i);
  const Knot &a = knots_[i], &b = knots_[i + 1];
  // ln S = a + t (m + (1 - t) ((p - m) (1 - t) - (q - m) t)), m the chord, p and q the slopes.
  const double chord = b.logarithm - a.logarithm;
  const double p = a.slope * kStep - chord, q = b.slope * kStep - chord;
  const double inner = p * (1 - t) - q * t;
  const double value = std::exp(a.logarithm + t * (chord + (1 - t) * inner));
  const double slope = chord + (1 - 2 * t) * inner - t * (1 - t) * (p + q);
  return {value, value * slope / kStep};
}

}  // namespace plenoflame
