#include "render/forward/bundle_collisions.h"

namespace plenoflame {

BundleCollisions::BundleCollisions(const CompiledScene& scene, const MajorantGrid& majorants)
    : scene_(scene),
      medium_(*scene.medium),
      majorants_(majorants),
      coefficients_(static_cast<std::size_t>(medium_.channel_count())) {}

BundleCollisions::Event BundleCollisions::next(const Ray& ray, double end, std::size_t driver,
                                               NoiseStream& noise) {
  Event event;
  majorants_.draw(ray, {0, end}, driver, noise, event.t, [&](double t, double majorant) {
    const Vec3 place = ray.at(t);
    // The events share the interval up to the majorant: scattering by each flame, then absorption.
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
      return true;
    }
    medium_.absorptions(place, coefficients_.data());
    if (!(rate < coefficients_[driver])) return false;
    event.fate = Fate::absorbed;
    return true;
  });
  return event;
}

}  // namespace plenoflame
