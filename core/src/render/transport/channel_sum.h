#pragma once
#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "plenoflame/media/medium.h"
#include "plenoflame/radiometry/channel_mix.h"

namespace plenoflame {

/// Sums node values to channels in place. Node n is at rows + n * stride, and rows of channels
/// replace the rows of nodes.
/// @param mix empty: nothing is done
template <class Real>
void sum_channels(const ChannelMix& mix, Real* rows, int stride, int count) {
  if (mix.empty()) return;
  constexpr int kColumns = 64;  // of all rows at a time: channels overwrite nodes
  std::vector<Real> sums(static_cast<std::size_t>(mix.channels()) * kColumns);
  for (int begin = 0; begin < count; begin += kColumns) {
    const int columns = std::min(kColumns, count - begin);
    std::fill(sums.begin(), sums.end(), Real(0));
    for (int c = 0; c < mix.channels(); ++c) {
      Real* const to = sums.data() + c * kColumns;
      for (int n = 0; n < mix.nodes(); ++n) {
        const auto weight = static_cast<Real>(mix.weight(c, n));
        if (weight == 0) continue;
        const Real* const from = rows + static_cast<std::ptrdiff_t>(n) * stride + begin;
        for (int i = 0; i < columns; ++i) to[i] += weight * from[i];
      }
    }
    for (int c = 0; c < mix.channels(); ++c)
      std::copy_n(sums.data() + c * kColumns, columns,
                  rows + static_cast<std::ptrdiff_t>(c) * stride + begin);
  }
}

/// The same for columns with different mixes. @param mixes with equal numbers of channels and nodes
/// @param mix_of number of each column's mix
template <class Real>
void sum_channels_by_mix(const std::vector<ChannelMix>& mixes, const int* mix_of, Real* rows,
                         int stride, int count) {
  const int channels = mixes.front().channels(), nodes = mixes.front().nodes();
  std::vector<Real> weights;
  for (const ChannelMix& mix : mixes)
    for (int c = 0; c < channels; ++c)
      for (int n = 0; n < nodes; ++n) weights.push_back(static_cast<Real>(mix.weight(c, n)));
  std::vector<Real> sums(static_cast<std::size_t>(channels));
  for (int i = 0; i < count; ++i) {
    const Real* weight = weights.data() + static_cast<std::ptrdiff_t>(mix_of[i]) * channels * nodes;
    for (int c = 0; c < channels; ++c) {
      Real sum = 0;
      for (int n = 0; n < nodes; ++n, ++weight)
        if (*weight != 0) sum += *weight * rows[static_cast<std::ptrdiff_t>(n) * stride + i];
      sums[static_cast<std::size_t>(c)] = sum;
    }
    for (int c = 0; c < channels; ++c)
      rows[static_cast<std::ptrdiff_t>(c) * stride + i] = sums[static_cast<std::size_t>(c)];
  }
}

/// A medium whose channels are sums of the channels of another medium. Its transmittance along
/// whole lines is that of the other medium's first channel.
class ChannelSum : public Medium {
 public:
  ChannelSum(const Medium& medium, ChannelMix mix) : medium_(medium), mix_(std::move(mix)) {}

  int channel_count() const override { return mix_.channels(); }
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
  ChannelMix mix_;
};

}  // namespace plenoflame
