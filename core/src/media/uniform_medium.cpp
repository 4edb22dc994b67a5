#include "plenoflame/media/uniform_medium.h"

namespace plenoflame {
namespace {

constexpr double kExtent = 1e3;  // [m] beyond any scene, small enough for single precision

class UniformMedium : public Medium {
 public:
  UniformMedium(double radiance, int channels) : radiance_(radiance), channels_(channels) {}

  int channel_count() const override { return channels_; }
  Box bounds() const override {
    return {{-kExtent, -kExtent, -kExtent}, {kExtent, kExtent, kExtent}};
  }
  double feature_size() const override { return 1; }
  void integrate(const RayBatch<float>& rays, const MediumOptions&, RadianceBatch<float> out,
                 MediumCounters& counters) const override {
    fill(rays, out, counters);
  }
  void integrate(const RayBatch<double>& rays, const MediumOptions&, RadianceBatch<double> out,
                 MediumCounters& counters) const override {
    fill(rays, out, counters);
  }
  // Opaque and of a source function that does not depend on the temperature.
  MediumSample sample(Vec3) const override { return {1, 1}; }
  double source(int, double) const override { return radiance_; }
  void append_breakpoints(const Ray&, std::vector<double>&) const override {}
  std::string description() const override { return "uniform radiance everywhere"; }

 private:
  template <class Real>
  void fill(const RayBatch<Real>& rays, RadianceBatch<Real> out, MediumCounters& counters) const {
    for (int c = 0; c < channels_; ++c)
      for (int i = 0; i < rays.size; ++i)
        out.radiance[c * out.stride + i] = static_cast<Real>(radiance_);
    if (out.transmittance)
      for (int c = 0; c < (out.transmittance_stride ? channels_ : 1); ++c)
        for (int i = 0; i < rays.size; ++i)
          out.transmittance[c * out.transmittance_stride + i] = Real(0);
    counters.rays += rays.size;
  }
  double radiance_;
  int channels_;
};

}  // namespace

std::unique_ptr<Medium> make_uniform_medium(double radiance, int channels) {
  return std::make_unique<UniformMedium>(radiance, channels);
}

}  // namespace plenoflame
