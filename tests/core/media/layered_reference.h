#pragma once
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "plenoflame/media/layered_medium.h"

namespace plenoflame::test {

struct ReferenceResult {
  long double radiance = 0, transmittance = 1;
};

/// Radiance through overlapping ellipsoids in 64-bit mantissa arithmetic, straight from the
/// definition: quadratic formula, all ends sorted, first layer that holds the middle.
inline ReferenceResult layered_reference(const std::vector<EllipsoidLayer>& layers,
                                         const RigidTransform& to_world,
                                         const SourceFunction& source, const Ray& ray,
                                         double t_near, double t_far) {
  using Real = long double;
  const auto& m = to_world.rotation.rows;
  const Real o[3] = {Real(ray.origin.x) - to_world.translation.x,
                     Real(ray.origin.y) - to_world.translation.y,
                     Real(ray.origin.z) - to_world.translation.z};
  const Real d[3] = {ray.direction.x, ray.direction.y, ray.direction.z};
  const auto column = [&](int i, const Real* v) {
    const auto pick = [&](const Vec3& row) { return i == 0 ? row.x : i == 1 ? row.y : row.z; };
    return pick(m[0]) * v[0] + pick(m[1]) * v[1] + pick(m[2]) * v[2];
  };
  std::vector<std::pair<Real, Real>> spans;
  std::vector<Real> ends;
  for (const EllipsoidLayer& layer : layers) {
    const Real axes[3] = {layer.semi_axes.x, layer.semi_axes.y, layer.semi_axes.z};
    const Real centre[3] = {layer.centre.x, layer.centre.y, layer.centre.z};
    Real a = 0, b = 0, c = -1;
    for (int i = 0; i < 3; ++i) {
      const Real u = (column(i, o) - centre[i]) / axes[i], v = column(i, d) / axes[i];
      a += v * v;
      b += u * v;
      c += u * u;
    }
    const Real discriminant = b * b - a * c;
    if (discriminant <= 0) {
      spans.push_back({0, 0});
      continue;
    }
    const Real root = std::sqrt(discriminant);
    const Real from = std::max(Real(t_near), (-b - root) / a);
    const Real to = std::min(Real(t_far), (-b + root) / a);
    spans.push_back({from, to});
    if (from < to) ends.insert(ends.end(), {from, to});
  }
  std::sort(ends.begin(), ends.end());
  ReferenceResult result;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    const Real middle = (ends[i] + ends[i + 1]) / 2;
    for (std::size_t k = 0; k < layers.size(); ++k) {
      if (middle < spans[k].first || middle > spans[k].second) continue;
      const Real tau = layers[k].absorption * (ends[i + 1] - ends[i]);
      result.radiance -= result.transmittance * std::expm1(-tau) * source(layers[k].temperature);
      result.transmittance *= std::exp(-tau);
      break;
    }
  }
  return result;
}

/// Random layers and rays of one seed; the same on every platform.
class Generator {
 public:
  explicit Generator(unsigned seed) : engine_(seed) {}
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_()) / 4294967295.0);
  }
  double logarithmic(double low, double high) {
    return low * std::exp(uniform(0, 1) * std::log(high / low));
  }
  Vec3 point(double extent) {
    return {uniform(-extent, extent), uniform(-extent, extent), uniform(-extent, extent)};
  }
  Vec3 direction() {
    for (;;) {
      const Vec3 p = point(1);
      const double length2 = dot(p, p);
      if (length2 > 0.01 && length2 < 1) return normalize(p);
    }
  }

 private:
  std::mt19937 engine_;
};

}  // namespace plenoflame::test
