#pragma once
#include <vector>

#include "render/sampling/backward_kernel.h"

namespace plenoflame {

/// The light that a pixel records where the sensor blurs (SensorSpec::blur), along rows or columns:
/// of what arrives at an offset from its middle, the share that the Gaussian takes to within the
/// pixel. Points are drawn from a density near to that one, and so count nearly the same.
class SensorBlur {
 public:
  /// @param deviation of the Gaussian [pixels], above 0
  explicit SensorBlur(double deviation);
  /// The share of all points that are drawn at lower offsets [pixels].
  double share(double offset) const;
  template <class Real>
  void fill(KernelBlur<Real>& kernel) const;

 private:
  std::vector<double> at_, low_, high_;  ///< as in KernelBlur
};

}  // namespace plenoflame
