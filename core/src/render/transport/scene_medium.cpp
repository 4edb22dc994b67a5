#include "render/transport/scene_medium.h"

#include <algorithm>
#include <cmath>

namespace plenoflame {
namespace {

/// The medium of a scene without flames.
class EmptyMedium : public Medium {
 public:
  EmptyMedium(int channels, const Box& box) : channels_(channels), box_(box) {}
  int channel_count() const override { return channels_; }
  Box bounds() const override { return box_; }
  double feature_size() const override { return 1; }
  void integrate(const RayBatch<float>& rays, const MediumOptions&, RadianceBatch<float> out,
                 MediumCounters&) const override {
    fill(rays.size, out);
  }
  void integrate(const RayBatch<double>& rays, const MediumOptions&, RadianceBatch<double> out,
                 MediumCounters&) const override {
    fill(rays.size, out);
  }
  MediumSample sample(Vec3) const override { return {}; }
  double source(int, double) const override { return 0; }
  void append_breakpoints(const Ray&, std::vector<double>&) const override {}
  std::string description() const override { return "none"; }

 private:
  template <class Real>
  void fill(int count, RadianceBatch<Real> out) const {
    for (int c = 0; c < channels_; ++c) std::fill_n(out.radiance + c * out.stride, count, Real(0));
    for (int c = 0; c < (out.transmittance_stride ? channels_ : 1); ++c)
      std::fill_n(out.transmittance + c * out.transmittance_stride, count, Real(1));
  }
  int channels_;
  Box box_;
};

Box box_ahead(const Camera& camera) {
  const double distance = camera.spec().focus.object_distance;
  const double ahead = distance > 0 && std::isfinite(distance) ? distance : 1.0;
  const Vec3 middle = camera.to_world().point({0, 0, ahead});
  const double half = 0.05 * ahead;
  return {middle - Vec3{half, half, half}, middle + Vec3{half, half, half}};
}

std::unique_ptr<Medium> empty_medium(const CompiledScene& scene) {
  if (scene.medium) return nullptr;
  const bool ends = scene.surfaces && !scene.surfaces->bounds().empty();
  return std::make_unique<EmptyMedium>(scene.node_count(),
                                       ends ? scene.surfaces->bounds() : box_ahead(scene.camera));
}

}  // namespace

SceneMedium::SceneMedium(const CompiledScene& scene)
    : empty_(empty_medium(scene)), medium_(scene.medium ? *scene.medium : *empty_) {}

bool has_content(const CompiledScene& scene) {
  return scene.medium || scene.surfaces || !scene.lights.environment.empty();
}

}  // namespace plenoflame
