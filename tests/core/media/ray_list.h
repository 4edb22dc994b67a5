#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "plenoflame/math/ray_batch.h"
#include "plenoflame/media/medium.h"

namespace plenoflame::test {

/// Rays for a test, padded to whole batches, and their results.
template <class Real>
class RayList {
 public:
  explicit RayList(Vec3 anchor = {}) : anchor_(anchor) {}

  void add(Vec3 origin, Vec3 direction, double t_near = -std::numeric_limits<double>::infinity(),
           double t_far = std::numeric_limits<double>::infinity()) {
    const Vec3 p = origin - anchor_;
    const double values[8] = {p.x, p.y, p.z, direction.x, direction.y, direction.z, t_near, t_far};
    for (std::size_t i = 0; i < 8; ++i) columns_[i].push_back(static_cast<Real>(values[i]));
  }
  std::size_t size() const { return columns_[0].size(); }
  /// The ray as the medium receives it, after rounding.
  Ray ray(std::size_t i) const {
    const auto v = [&](std::size_t c) { return static_cast<double>(columns_[c][i]); };
    return {anchor_ + Vec3{v(0), v(1), v(2)}, {v(3), v(4), v(5)}};
  }

  double near(std::size_t i) const { return static_cast<double>(columns_[6][i]); }
  double far(std::size_t i) const { return static_cast<double>(columns_[7][i]); }

  struct Results {
    std::vector<std::vector<Real>> radiance;  ///< per channel
    std::vector<Real> transmittance;
    MediumCounters counters;
  };
  Results integrate(const Medium& medium, const MediumOptions& options = {}) const {
    const auto channels = static_cast<std::size_t>(medium.channel_count());
    Results results;
    results.radiance.resize(channels);
    for (std::size_t first = 0; first < size(); first += kMaxBatch) {
      const std::size_t count = std::min<std::size_t>(kMaxBatch, size() - first);
      const std::size_t padded = (count + kRayPadding - 1) / kRayPadding * kRayPadding;
      alignas(64) static thread_local Real in[8][kMaxBatch];
      alignas(64) Real transmittance[kMaxBatch];
      std::vector<Real> radiance(channels * kMaxBatch, Real(-1));
      for (std::size_t c = 0; c < 8; ++c)
        for (std::size_t i = 0; i < padded; ++i)
          in[c][i] = columns_[c][first + (i < count ? i : count - 1)];
      const RayBatch<Real> batch{static_cast<int>(padded),
                                 anchor_,
                                 in[0],
                                 in[1],
                                 in[2],
                                 in[3],
                                 in[4],
                                 in[5],
                                 limits(6) ? in[6] : nullptr,
                                 limits(7) ? in[7] : nullptr};
      medium.integrate(batch, options,
                       RadianceBatch<Real>{radiance.data(), kMaxBatch, transmittance},
                       results.counters);
      for (std::size_t c = 0; c < channels; ++c)
        results.radiance[c].insert(results.radiance[c].end(), radiance.data() + c * kMaxBatch,
                                   radiance.data() + c * kMaxBatch + count);
      results.transmittance.insert(results.transmittance.end(), transmittance,
                                   transmittance + count);
    }
    return results;
  }

 private:
  /// Tells if a column of limits cuts any ray: media are told of none in another way.
  bool limits(std::size_t column) const {
    return std::any_of(columns_[column].begin(), columns_[column].end(),
                       [](Real t) { return !std::isinf(t); });
  }

  Vec3 anchor_;
  std::vector<Real> columns_[8];
};

}  // namespace plenoflame::test
