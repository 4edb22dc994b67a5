#include "render/bundle_collisions.h"

#include <cmath>

#include "plenoflame/base/error.h"
#include "plenoflame/math/ray_span.h"

namespace plenoflame {

BundleCollisions::BundleCollisions(const CompiledScene& scene)
    : scene_(scene),
      medium_(*scene.medium),
      bounds_(medium_.bounds()),
      majorant_(medium_.largest_absorption()),
      coefficients_(static_cast<std::size_t>(medium_.channel_count())) {
  if (!std::isfinite(majorant_))
    throw InputError("this medium does not know its largest absorption, which scattering needs");
}

BundleCollisions::Event BundleCollisions::next(const Ray& ray, double end, NoiseStream& noise) {
  const RaySpan span = clip_to_box(bounds_, ray, 0, end);
  if (span.empty() || !(majorant_ > 0)) return {};
  Event event;
  for (event.t = span.near;;) {
    event.t -= std::log(noise.uniform()) / majorant_;
    if (!(event.t < span.far)) return {};
    const Vec3 place = ray.at(event.t);
    // The rate of what may happen, one kind above the other, up to the largest absorption.
    const double rate = noise.uniform() * majorant_;
    double scattered = 0;
    for (const Scatterer& scatterer : scene_.scatterers) {
      scatterer.medium->absorptions(place, coefficients_.data());
      scattered += scatterer.albedo(place) * coefficients_[0];
      if (!(rate < scattered)) continue;
      for (std::size_t c = 1; c < coefficients_.size(); ++c) coefficients_[c] /= coefficients_[0];
      coefficients_[0] = 1;
      event.fate = Fate::scattered;
      event.scatterer = &scatterer;
      event.relative = coefficients_.data();
      return event;
    }
    medium_.absorptions(place, coefficients_.data());
    if (rate < coefficients_[0]) {
      event.fate = Fate::absorbed;
      return event;
    }
  }
}

}  // namespace plenoflame
