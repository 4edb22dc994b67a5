#pragma once
#include <functional>
#include <vector>

#include "plenoflame/media/medium.h"

namespace plenoflame::test {

/// A medium from two functions of x, in a box; its source function is the "temperature" itself,
/// times (channel + 1). Integrates with nothing: for the reference integrator and for composites.
class FieldMedium : public Medium {
 public:
  using Field = std::function<double(double x)>;
  FieldMedium(Field absorption, Field source, Box box, std::vector<double> kinks = {})
      : absorption_(std::move(absorption)),
        source_(std::move(source)),
        box_(box),
        kinks_(std::move(kinks)) {}

  int channel_count() const override { return 2; }
  Box bounds() const override { return box_; }
  double feature_size() const override { return 1; }
  void integrate(const RayBatch<float>&, const MediumOptions&, RadianceBatch<float>,
                 MediumCounters&) const override {}
  void integrate(const RayBatch<double>&, const MediumOptions&, RadianceBatch<double>,
                 MediumCounters&) const override {}
  MediumSample sample(Vec3 p) const override {
    const auto& [low, high] = box_;
    if (p.x < low.x || p.x > high.x || p.y < low.y || p.y > high.y || p.z < low.z || p.z > high.z)
      return {};
    return {source_(p.x), absorption_(p.x)};
  }
  double source(int channel, double temperature) const override {
    return (channel + 1) * temperature;
  }
  /// Kinks are places x; rays must run along x.
  void append_breakpoints(const Ray& ray, std::vector<double>& t) const override {
    for (const double x : kinks_) t.push_back((x - ray.origin.x) / ray.direction.x);
  }
  std::string description() const override { return "fields"; }

 private:
  Field absorption_, source_;
  Box box_;
  std::vector<double> kinks_;
};

}  // namespace plenoflame::test
