#pragma once
#include <vector>

#include "plenoflame/math/vector.h"
#include "plenoflame/media/medium.h"

namespace plenoflame {

/// Integrates a medium along any number of stretches of lines, in one precision; one object per
/// worker.
template <class Real>
class BasicMediumSegments {
 public:
  /// @param medium nullptr: every stretch is transparent
  BasicMediumSegments(const Medium* medium, const MediumOptions& options);

  void clear() { rays_.clear(), far_.clear(); }
  /// Adds the stretch 0 < t < t_far. @return its number
  std::size_t add(const Ray& ray, double t_far) {
    rays_.push_back(ray);
    far_.push_back(t_far);
    return rays_.size() - 1;
  }
  /// Integrates the added stretches. @param with_radiance false: only the transmittance is computed
  void integrate(bool with_radiance, MediumCounters& counters);

  /// Transmittance in the first channel, or in all channels if the medium is grey.
  double transmittance(std::size_t segment) const { return transmittance_[segment * passes_]; }
  double transmittance(std::size_t segment, std::size_t channel) const {
    return transmittance_[segment * passes_ + (passes_ > 1 ? channel : 0)];
  }
  /// Tells whether the transmittance is equal in all channels.
  bool is_grey() const { return passes_ == 1; }
  /// [W/(m^2 sr)] that arrives at t = 0.
  double radiance(std::size_t segment, int channel) const {
    return radiance_[segment * channels_ + static_cast<std::size_t>(channel)];
  }

 private:
  bool meets(const Ray& ray, double t_far) const;
  void integrate_batch(std::size_t first, std::size_t count, bool with_radiance,
                       MediumCounters& counters);

  const Medium* medium_;
  MediumOptions options_;
  Box bounds_;
  std::size_t channels_ = 0, passes_ = 1;  ///< passes_: number of different transmittances
  std::vector<Ray> rays_;
  std::vector<double> far_, transmittance_, radiance_;
  std::vector<std::size_t> inside_;  ///< segments that meet the medium's bounds
  std::vector<Real> storage_;        ///< arrays of one batch
};

using MediumSegments = BasicMediumSegments<double>;

}  // namespace plenoflame
