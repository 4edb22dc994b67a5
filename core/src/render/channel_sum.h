#pragma once
#include <vector>

#include "plenoflame/media/medium.h"

namespace plenoflame {

/// Rows of node values, node n at rows + n * stride, become rows of channels in the same place.
/// @param channel_of_node ascending; empty: nodes are channels, nothing is done
template <class Real>
void sum_channels(const std::vector<int>& channel_of_node, Real* rows, int stride, int count) {
  for (std::size_t n = 0; n < channel_of_node.size(); ++n) {
    const int channel = channel_of_node[n];
    // Never behind the node's own row: what it overwrites has been used.
    Real* const to = rows + static_cast<std::ptrdiff_t>(channel) * stride;
    const Real* const from = rows + static_cast<std::ptrdiff_t>(n) * stride;
    const bool first = n == 0 || channel_of_node[n - 1] != channel;
    for (int i = 0; i < count; ++i) to[i] = first ? from[i] : to[i] + from[i];
  }
}

/// A medium whose channels are sums of another one's. Of whole lines: transmittance is that of the
/// other's first channel.
class ChannelSum : public Medium {
 public:
  ChannelSum(const Medium& medium, std::vector<int> channel_of_node)
      : medium_(medium), channel_of_node_(std::move(channel_of_node)) {}

  int channel_count() const override { return channel_of_node_.back() + 1; }
  Box bounds() const override { return medium_.bounds(); }
  std::vector<Box> occupied() const override { return medium_.occupied(); }
  bool is_costly() const override { return medium_.is_costly(); }
  double feature_size() const override { return medium_.feature_size(); }
  void integrate(const RayBatch<float>& rays, const MediumOptions& options,
                 RadianceBatch<float> out, MediumCounters& counters) const override {
    run(rays, options, out, counters);
  }
  void integrate(const RayBatch<double>& rays, const MediumOptions& options,
                 RadianceBatch<double> out, MediumCounters& counters) const override {
    run(rays, options, out, counters);
  }
  MediumSample sample(Vec3 world) const override { return medium_.sample(world); }
  double source(int channel, double temperature) const override;
  double coefficients(Vec3 world, double* emission) const override;
  void append_breakpoints(const Ray& ray, std::vector<double>& t) const override {
    medium_.append_breakpoints(ray, t);
  }
  std::string description() const override { return medium_.description(); }

 private:
  template <class Real>
  void run(const RayBatch<Real>& rays, const MediumOptions& options, RadianceBatch<Real> out,
           MediumCounters& counters) const;

  const Medium& medium_;
  std::vector<int> channel_of_node_;
};

}  // namespace plenoflame
