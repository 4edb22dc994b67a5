#pragma once
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "plenoflame/media/medium.h"

namespace plenoflame::test {

/// A textured plane across the world's x axis that glows: a ray sees texture(y, z) where it meets
/// the plane. For the presets' cameras, which look along +x, it is a target at that distance.
class PlaneMedium : public Medium {
 public:
  using Texture = std::function<double(double y, double z)>;
  PlaneMedium(double x, double half_width, Texture texture)
      : x_(x), half_(half_width), texture_(std::move(texture)) {}

  int channel_count() const override { return 1; }
  Box bounds() const override { return {{x_ - 1e-6, -half_, -half_}, {x_ + 1e-6, half_, half_}}; }
  double feature_size() const override { return half_; }
  void integrate(const RayBatch<float>& rays, const MediumOptions&, RadianceBatch<float> out,
                 MediumCounters& counters) const override {
    run(rays, out, counters);
  }
  void integrate(const RayBatch<double>& rays, const MediumOptions&, RadianceBatch<double> out,
                 MediumCounters& counters) const override {
    run(rays, out, counters);
  }
  MediumSample sample(Vec3) const override { return {1, 1}; }
  double source(int, double) const override { return 1; }
  void append_breakpoints(const Ray&, std::vector<double>&) const override {}
  std::string description() const override { return "plane"; }

 private:
  template <class Real>
  void run(const RayBatch<Real>& rays, RadianceBatch<Real> out, MediumCounters& counters) const {
    for (int i = 0; i < rays.size; ++i) {
      const Vec3 o =
          rays.anchor + Vec3{static_cast<double>(rays.x[i]), static_cast<double>(rays.y[i]),
                             static_cast<double>(rays.z[i])};
      const double t = (x_ - o.x) / static_cast<double>(rays.dx[i]);
      const double y = o.y + t * static_cast<double>(rays.dy[i]);
      const double z = o.z + t * static_cast<double>(rays.dz[i]);
      const bool hit = std::abs(y) <= half_ && std::abs(z) <= half_;
      out.radiance[i] = hit ? static_cast<Real>(texture_(y, z)) : Real(0);
      counters.rays += 1;
    }
  }
  double x_, half_;
  Texture texture_;
};

}  // namespace plenoflame::test
