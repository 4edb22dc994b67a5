#pragma once
#include <vector>

#include "plenoflame/sampling/noise.h"
#include "plenoflame/scene/compile.h"

namespace plenoflame {

/// What a medium does to bundles of light, drawn as it happens: places of extinction by delta
/// tracking (Woodcock et al., ANL-7050, 1965), and there whether the bundle is absorbed or which
/// flame scatters it, all at the first node. One per worker.
class BundleCollisions {
 public:
  /// @throws InputError when the medium does not know its largest absorption
  explicit BundleCollisions(const CompiledScene& scene);

  enum class Fate { passed, scattered, absorbed };
  struct Event {
    Fate fate = Fate::passed;
    double t = 0;                          ///< [m] along the ray
    const Scatterer* scatterer = nullptr;  ///< of what is scattered
    /// Of that, what is scattered at each node relative to the first; until the next call.
    const double* relative = nullptr;
  };
  /// The fate of a bundle at 0 < t < end.
  Event next(const Ray& ray, double end, NoiseStream& noise);

 private:
  const CompiledScene& scene_;
  const Medium& medium_;
  Box bounds_;
  double majorant_;
  std::vector<double> coefficients_;
};

}  // namespace plenoflame
