#include "render/bundle_collisions.h"

#include <cmath>

#include "plenoflame/math/ray_span.h"

namespace plenoflame {

BundleCollisions::BundleCollisions(const CompiledScene& scene)
    : scene_(scene),
      medium_(*scene.medium),
      bounds_(medium_.bounds()),
      majorants_(medium_.majorants()),
      coefficients_(static_cast<std::size_t>(medium_.channel_count())) {}

BundleCollisions::Event BundleCollisions::next(const Ray& ray, double end, std::size_t driver,
                                               NoiseStream& noise) {
  const RaySpan span = clip_to_box(bounds_, ray, 0, end);
  const double majorant = majorants_[driver];
  if (span.empty() || !(majorant > 0)) return {};
  Event event;
  for (event.t = span.near;;) {
    event.t -= std::log(noise.uniform()) / majorant;
    if (!(event.t < span.far)) return {};
    const Vec3 place = ray.at(event.t);
    // The rate of what may happen, one kind above the other, up to the largest absorption.
    const double rate = noise.uniform() * majorant;
    double scattered = 0;
    for (const Scatterer& scatterer : scene_.scatterers) {
      scatterer.medium->absorptions(place, coefficients_.data());
      const double albedo = scatterer.albedo(place);
      scattered += albedo * coefficients_[driver];
      if (!(rate < scattered)) continue;
      for (double& coefficient : coefficients_) coefficient *= albedo;
      event.fate = Fate::scattered;
      event.scatterer = &scatterer;
      event.scattering = coefficients_.data();
      return event;
    }
    medium_.absorptions(place, coefficients_.data());
    if (rate < coefficients_[driver]) {
      event.fate = Fate::absorbed;
      return event;
    }
  }
}

}  // namespace plenoflame
