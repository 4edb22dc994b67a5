#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "plenoflame/math/vector.h"

/// Values and axes of slices, for reports and the desktop application.
namespace plenoflame {

/// The edges of the first and the last cell along a side of a slice [mm].
struct SliceAxis {
  std::string label;
  double first = 0, last = 0;
};

/// Numbers are those of the world along one of its axes, else they count from the first cell.
/// @param first middle of the first cell [m]  @param way unit vector  @param spacing [m]
inline SliceAxis slice_axis(const Vec3& first, const Vec3& way, double spacing, double cells) {
  const double along[] = {way.x, way.y, way.z}, start[] = {first.x, first.y, first.z};
  const double step = 1e3 * spacing;
  for (std::size_t k = 0; k < 3; ++k)
    if (std::fabs(along[k]) > 0.999999) {
      const double signed_step = std::copysign(step, along[k]);
      const double edge = 1e3 * start[k] - 0.5 * signed_step;
      return {std::string{"xyz"[k]} + " [mm]", edge, edge + cells * signed_step};
    }
  return {"along the grid [mm]", -0.5 * step, (cells - 0.5) * step};
}

/// Found value minus truth; no numbers where the scene is dark or the value is none.
template <class Value>
std::vector<Value> errors_of(const std::vector<Value>& found, const std::vector<Value>& truth) {
  std::vector<Value> errors(truth.size(), std::numeric_limits<Value>::quiet_NaN());
  for (std::size_t j = 0; j < errors.size(); ++j)
    if (truth[j] > 0) errors[j] = found[j] - truth[j];
  return errors;
}

/// The largest size of values where the flame emits at least a twentieth of its maximum: elsewhere
/// they may be any. Without emission, everywhere.
template <class Value>
double size_where_lit(const std::vector<Value>& values, const std::vector<Value>& emission) {
  const Value least = emission.empty() ? 0 : *std::ranges::max_element(emission) / 20;
  double size = 0;
  for (std::size_t j = 0; j < values.size(); ++j)
    if (std::isfinite(values[j]) && (emission.empty() || emission[j] >= least))
      size = std::max(size, std::fabs(static_cast<double>(values[j])));
  return size;
}

}  // namespace plenoflame
