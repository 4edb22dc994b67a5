#include "plenoflame/media/medium.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "media/transfer.h"
#include "plenoflame/base/error.h"
#include "plenoflame/math/ray_span.h"

namespace plenoflame {

double Medium::coefficients(Vec3 world, double* emission) const {
  const MediumSample here = sample(world);
  if (is_grey()) {
    for (int c = 0; c < channel_count(); ++c)
      emission[c] = here.absorption * source(c, here.temperature);
    return here.absorption;
  }
  absorptions(world, emission);
  const double first = emission[0];
  for (int c = 0; c < channel_count(); ++c) emission[c] *= source(c, here.temperature);
  return first;
}

double Medium::largest_absorption(int) const {
  return std::numeric_limits<double>::infinity();
}

std::vector<double> Medium::majorants() const {
  std::vector<double> all;
  for (int c = 0; c < channel_count(); ++c) all.push_back(largest_absorption(c));
  if (!std::all_of(all.begin(), all.end(), [](double most) { return std::isfinite(most); }))
    throw InputError("this medium does not know its largest absorption, which scattering needs");
  return all;
}

void Medium::absorptions(Vec3 world, double* each) const {
  std::fill_n(each, channel_count(), sample(world).absorption);
}

std::vector<double> integrate_reference(const Medium& medium, const Ray& ray, double t_near,
                                        double t_far, double relative_tolerance) {
  const RaySpan span = clip_to_box(medium.bounds(), ray, t_near, t_far);
  TransferResult result;
  result.radiance.assign(static_cast<std::size_t>(medium.channel_count()), 0.0);
  if (!span.empty()) {
    std::vector<double> all, limits{span.near};
    medium.append_breakpoints(ray, all);
    std::sort(all.begin(), all.end());
    for (const double t : all)
      if (t > limits.back() && t < span.far) limits.push_back(t);
    limits.push_back(span.far);
    result = integrate_transfer(
        [&](double t, double* emission) { return medium.coefficients(ray.at(t), emission); },
        medium.channel_count(), limits, relative_tolerance);
    // Channels that differ in absorption have a transfer of their own each.
    const auto channels = static_cast<std::size_t>(medium.channel_count());
    std::vector<double> emissions(channels), each(channels);
    for (std::size_t c = 1; c < channels && !medium.is_grey(); ++c)
      result.radiance[c] = integrate_transfer(
                               [&](double t, double* emission) {
                                 medium.coefficients(ray.at(t), emissions.data());
                                 medium.absorptions(ray.at(t), each.data());
                                 *emission = emissions[c];
                                 return each[c];
                               },
                               1, limits, relative_tolerance)
                               .radiance[0];
  }
  result.radiance.push_back(result.optical_thickness);
  return result.radiance;
}

}  // namespace plenoflame
