#pragma once
#include <vector>

#include "media/voxels/majorant_grid.h"
#include "plenoflame/sampling/noise.h"
#include "plenoflame/scene/compile.h"

namespace plenoflame {

/// Collisions of bundles of light in a medium, drawn as they happen: places of extinction by delta
/// tracking (Woodcock et al., ANL-7050, 1965), and there whether the bundle is absorbed or which
/// flame scatters it, all at one of the nodes. One per worker.
class BundleCollisions {
 public:
  /// @param majorants of the scene's medium; kept
  BundleCollisions(const CompiledScene& scene, const MajorantGrid& majorants);

  enum class Fate { passed, scattered, absorbed };
  struct Event {
    Fate fate = Fate::passed;
    double t = 0;                          ///< [m] along the ray
    const Scatterer* scatterer = nullptr;  ///< of what is scattered
    /// [1/m] What that one scatters there at each node; until the next call.
    const double* scattering = nullptr;
  };
  /// The fate of a bundle at 0 < t < end. @param driver the node at which it is drawn
  Event next(const Ray& ray, double end, std::size_t driver, NoiseStream& noise);

 private:
  const CompiledScene& scene_;
  const Medium& medium_;
  const MajorantGrid& majorants_;
  std::vector<double> coefficients_;
};

}  // namespace plenoflame
