#pragma once
#include <vector>

#include "media/voxels/majorant_grid.h"
#include "plenoflame/sampling/noise.h"
#include "plenoflame/scene/compile.h"

namespace plenoflame {

/// Collisions of light bundles in a medium. Delta tracking draws the places of extinction (Woodcock
/// et al., ANL-7050, 1965). At each place a random number selects absorption or the flame that
/// scatters the bundle. All draws use one of the nodes. One object per worker.
class BundleCollisions {
 public:
  /// @param majorants of the scene's medium; kept by reference
  BundleCollisions(const CompiledScene& scene, const MajorantGrid& majorants);

  enum class Fate { passed, scattered, absorbed };
  struct Event {
    Fate fate = Fate::passed;
    double t = 0;                          ///< [m] along the ray
    const Scatterer* scatterer = nullptr;  ///< flame that scatters the bundle
    /// [1/m] Scattering coefficient of that flame there, at each node; valid until the next call.
    const double* scattering = nullptr;
  };
  /// The next event of a bundle at 0 < t < end, drawn at the node of its hero wavelength.
  Event next(const Ray& ray, double end, std::size_t driver, NoiseStream& noise);

 private:
  const CompiledScene& scene_;
  const Medium& medium_;
  const MajorantGrid& majorants_;
  std::vector<double> coefficients_;
};

}  // namespace plenoflame
