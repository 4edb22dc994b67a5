#include "plenoflame/media/medium_samples.h"

#include <algorithm>
#include <cmath>

#include "plenoflame/base/error.h"

namespace plenoflame {

namespace {

/// Fills in the values at the points of a lattice that is there.
void fill_samples(const Medium& medium, MediumSamples& out, const Execution& execution) {
  const auto [nx, ny, nz] = out.count;
  const std::size_t plane = static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny);
  out.temperature.resize(plane * static_cast<std::size_t>(nz));
  out.absorption.resize(out.temperature.size());
  const bool done = parallel_for(
      execution, static_cast<std::size_t>(nz), [&, nx = nx, ny = ny](std::size_t k, int) {
        std::size_t at = k * plane;
        for (int j = 0; j < ny; ++j)
          for (int i = 0; i < nx; ++i, ++at) {
            const MediumSample sample =
                medium.sample(out.origin + Vec3{i * out.step.x, j * out.step.y,
                                                static_cast<double>(k) * out.step.z});
            out.temperature[at] = static_cast<float>(sample.temperature);
            out.absorption[at] = static_cast<float>(sample.absorption);
          }
      });
  if (!done) throw Cancelled();
}

}  // namespace

MediumSamples sample_medium(const Medium& medium, SamplePlaces places, int longest,
                            const Execution& execution) {
  if (longest < 2) throw InputError("a medium is sampled at 2 points along a side at least");
  MediumSamples out;
  const Box box = medium.bounds();
  if (box.empty()) return out;
  const Vec3 size = box.upper - box.lower;
  const double most = std::max({size.x, size.y, size.z});
  if (!std::isfinite(most) || most <= 0) return out;
  if (places == SamplePlaces::nodes) {
    const double step = most / (longest - 1);
    const auto points = [&](double side) {
      return std::max(2, static_cast<int>(std::ceil(side / step - 1e-9)) + 1);
    };
    out.count = {points(size.x), points(size.y), points(size.z)};
    out.step = {step, step, step};
    const Vec3 span{step * (out.count[0] - 1), step * (out.count[1] - 1),
                    step * (out.count[2] - 1)};
    out.origin = box.lower - 0.5 * (span - size);
  } else {
    const auto points = [&](double side) {
      return std::max(2, static_cast<int>(std::lround(side / most * longest)));
    };
    out.count = {points(size.x), points(size.y), points(size.z)};
    out.step = {size.x / out.count[0], size.y / out.count[1], size.z / out.count[2]};
    out.origin = box.lower + 0.5 * out.step;
  }
  fill_samples(medium, out, execution);
  return out;
}

MediumSamples sample_medium(const Medium& medium, const Box& box, std::array<int, 3> count,
                            const Execution& execution) {
  const Vec3 size = box.upper - box.lower;
  if (box.empty() || !(size.x > 0) || !(size.y > 0) || !(size.z > 0))
    throw InputError("the box of a lattice has no volume");
  if (*std::min_element(count.begin(), count.end()) < 1)
    throw InputError("a lattice has one cell along a side at least");
  MediumSamples out;
  out.count = count;
  out.step = {size.x / count[0], size.y / count[1], size.z / count[2]};
  out.origin = box.lower + 0.5 * out.step;
  fill_samples(medium, out, execution);
  return out;
}

}  // namespace plenoflame
