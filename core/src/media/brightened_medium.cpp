#include "plenoflame/media/brightened_medium.h"

#include <fmt/format.h>

#include <utility>

namespace plenoflame {
namespace {

/// Radiance is linear in what is emitted, so that the factor may be applied to the integral.
class BrightenedMedium final : public Medium {
 public:
  BrightenedMedium(std::shared_ptr<const Medium> medium, double brightness)
      : medium_(std::move(medium)), brightness_(brightness) {}

  int channel_count() const override { return medium_->channel_count(); }
  Box bounds() const override { return medium_->bounds(); }
  std::vector<Box> occupied() const override { return medium_->occupied(); }
  bool is_costly() const override { return medium_->is_costly(); }
  bool is_grey() const override { return medium_->is_grey(); }
  double largest_absorption(int channel) const override {
    return medium_->largest_absorption(channel);
  }
  double largest_share(const Box& box) const override { return medium_->largest_share(box); }
  double feature_size() const override { return medium_->feature_size(); }

  void integrate(const RayBatch<float>& rays, const MediumOptions& options,
                 RadianceBatch<float> out, MediumCounters& counters) const override {
    medium_->integrate(rays, options, out, counters);
    brighten(rays.size, out);
  }
  void integrate(const RayBatch<double>& rays, const MediumOptions& options,
                 RadianceBatch<double> out, MediumCounters& counters) const override {
    medium_->integrate(rays, options, out, counters);
    brighten(rays.size, out);
  }

  MediumSample sample(Vec3 world) const override { return medium_->sample(world); }
  double source(int channel, double temperature) const override {
    return brightness_ * medium_->source(channel, temperature);
  }
  double coefficients(Vec3 world, double* emission) const override {
    const double absorption = medium_->coefficients(world, emission);
    for (int c = 0; c < channel_count(); ++c) emission[c] *= brightness_;
    return absorption;
  }
  void absorptions(Vec3 world, double* each) const override { medium_->absorptions(world, each); }
  double albedo(Vec3 world) const override { return medium_->albedo(world); }
  std::shared_ptr<const Medium> single_channel(int channel) const override {
    return brightened(medium_->single_channel(channel), brightness_);
  }
  void append_breakpoints(const Ray& ray, std::vector<double>& t) const override {
    medium_->append_breakpoints(ray, t);
  }
  std::string description() const override {
    return fmt::format("{}, {:.4g} times as bright", medium_->description(), brightness_);
  }

 private:
  template <class Real>
  void brighten(int size, RadianceBatch<Real> out) const {
    const auto factor = static_cast<Real>(brightness_);
    for (int c = 0; c < channel_count(); ++c)
      for (int i = 0; i < size; ++i) out.radiance[c * out.stride + i] *= factor;
  }

  std::shared_ptr<const Medium> medium_;
  double brightness_;
};

}  // namespace

std::shared_ptr<const Medium> brightened(std::shared_ptr<const Medium> medium, double brightness) {
  if (!medium || brightness == 1) return medium;
  return std::make_shared<BrightenedMedium>(std::move(medium), brightness);
}

}  // namespace plenoflame
