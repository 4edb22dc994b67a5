#pragma once
#include <vector>

#include "render/sampling/backward_kernel.h"

namespace plenoflame {

/// The light that a pixel records if the sensor blurs (SensorSpec::blur), along rows or columns.
/// For light at an offset from the pixel's middle, it is the share that the Gaussian brings into
/// the pixel. Points are drawn from a density close to this share, so that their weights are nearly
/// equal.
class SensorBlur {
 public:
  /// @param deviation of the Gaussian [pixels], above 0
  explicit SensorBlur(double deviation);
  /// The share of points that are drawn at lower offsets [pixels].
  double share(double offset) const;
  template <class Real>
  void fill(KernelBlur<Real>& kernel) const;

 private:
  std::vector<double> at_, low_, high_;  ///< as in KernelBlur
};

}  // namespace plenoflame
