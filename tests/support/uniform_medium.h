#pragma once
#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "plenoflame/media/medium.h"

namespace plenoflame::test {

/// A source of the same radiance in every direction: what a pixel then receives is pi times its
/// optics' view factor, and nothing depends on transport. Rays that miss the box see nothing.
class UniformMedium : public Medium {
 public:
  static constexpr double kRadiance = 1;  ///< [W/(m^2 sr)]
  /// Everywhere: every ray that leaves the camera sees it.
  UniformMedium() : box_{{-1e3, -1e3, -1e3}, {1e3, 1e3, 1e3}}, everywhere_(true) {}
  /// Only rays that meet the box see it.
  explicit UniformMedium(const Box& box) : box_(box), everywhere_(false) {}

  int channel_count() const override { return 1; }
  Box bounds() const override { return box_; }
  double feature_size() const override {
    return everywhere_ ? 1.0
                       : std::min({box_.upper.x - box_.lower.x, box_.upper.y - box_.lower.y,
                                   box_.upper.z - box_.lower.z});
  }
  void integrate(const RayBatch<float>& rays, const MediumOptions&, RadianceBatch<float> out,
                 MediumCounters& counters) const override {
    run(rays, out, counters);
  }
  void integrate(const RayBatch<double>& rays, const MediumOptions&, RadianceBatch<double> out,
                 MediumCounters& counters) const override {
    run(rays, out, counters);
  }
  MediumSample sample(Vec3) const override { return {1, 1}; }
  double source(int, double) const override { return kRadiance; }
  void append_breakpoints(const Ray&, std::vector<double>&) const override {}
  std::string description() const override { return "uniform"; }

  bool meets(Vec3 origin, Vec3 direction) const {
    if (everywhere_) return true;
    double near = -std::numeric_limits<double>::infinity(), far = -near;
    const auto slab = [&](double lower, double upper, double o, double d) {
      const double a = (lower - o) / d, b = (upper - o) / d;
      near = std::max(near, std::min(a, b));
      far = std::min(far, std::max(a, b));
    };
    slab(box_.lower.x, box_.upper.x, origin.x, direction.x);
    slab(box_.lower.y, box_.upper.y, origin.y, direction.y);
    slab(box_.lower.z, box_.upper.z, origin.z, direction.z);
    return near <= far;
  }

 private:
  template <class Real>
  void run(const RayBatch<Real>& rays, RadianceBatch<Real> out, MediumCounters& counters) const {
    for (int i = 0; i < rays.size; ++i) {
      const Vec3 at{static_cast<double>(rays.x[i]), static_cast<double>(rays.y[i]),
                    static_cast<double>(rays.z[i])};
      const Vec3 direction{static_cast<double>(rays.dx[i]), static_cast<double>(rays.dy[i]),
                           static_cast<double>(rays.dz[i])};
      const bool hit = meets(rays.anchor + at, direction);
      out.radiance[i] = hit ? static_cast<Real>(kRadiance) : Real(0);
      if (hit) counters.rays += 1;
    }
  }
  Box box_;
  bool everywhere_;
};

}  // namespace plenoflame::test
