#include "render/transport/channel_sum.h"

#include <algorithm>
#include <memory>

namespace plenoflame {

double ChannelSum::source(int channel, double temperature) const {
  double sum = 0;
  for (int n = 0; n < mix_.nodes(); ++n)
    if (const double weight = mix_.weight(channel, n); weight > 0)
      sum += weight * medium_.source(n, temperature);
  return sum;
}

double ChannelSum::coefficients(Vec3 world, double* emission) const {
  std::vector<double> nodes(static_cast<std::size_t>(mix_.nodes()));
  const double absorption = medium_.coefficients(world, nodes.data());
  sum_channels(mix_, nodes.data(), 1, 1);
  std::copy_n(nodes.begin(), channel_count(), emission);
  return absorption;
}

template <class Real>
void ChannelSum::run(const RayBatch<Real>& rays, const MediumOptions& options,
                     RadianceBatch<Real> out, MediumCounters& counters) const {
  const auto stride =
      static_cast<std::size_t>((rays.size + kRayPadding - 1) / kRayPadding * kRayPadding);
  const std::size_t size = static_cast<std::size_t>(mix_.nodes()) * stride;
  std::vector<Real> storage(size + 64 / sizeof(Real));
  void* aligned = storage.data();
  std::size_t space = storage.size() * sizeof(Real);
  Real* const nodes = static_cast<Real*>(std::align(64, size * sizeof(Real), aligned, space));
  medium_.integrate(rays, options,
                    RadianceBatch<Real>{nodes, static_cast<int>(stride), out.transmittance},
                    counters);
  sum_channels(mix_, nodes, static_cast<int>(stride), rays.size);
  for (int c = 0; c < channel_count(); ++c)
    std::copy_n(nodes + static_cast<std::size_t>(c) * stride, rays.size,
                out.radiance + static_cast<std::ptrdiff_t>(c) * out.stride);
}

template void ChannelSum::run<float>(const RayBatch<float>&, const MediumOptions&,
                                     RadianceBatch<float>, MediumCounters&) const;
template void ChannelSum::run<double>(const RayBatch<double>&, const MediumOptions&,
                                      RadianceBatch<double>, MediumCounters&) const;

}  // namespace plenoflame
