#pragma once
#include "optics/kernel_types.h"
#include "plenoflame/base/constants.h"
#include "plenoflame/scene/main_lens_spec.h"

namespace plenoflame {

/// For rays towards the scene the sag changes its sign with the direction of propagation.
template <class Real>
KernelAsphere<Real> kernel_asphere(const SurfaceSpec& surface, bool to_scene) {
  const double rim2 = surface.diameter > 0 && surface.diameter < kInfinity
                          ? 0.25 * surface.diameter * surface.diameter
                          : 1;
  KernelAsphere<Real> asphere{static_cast<Real>(surface.conic), static_cast<Real>(1 / rim2), {}};
  double scale = rim2 * rim2;
  for (std::size_t i = 0; i < surface.aspheric.size() && i < kAsphericTerms; ++i, scale *= rim2)
    asphere.terms[i] =
        static_cast<Real>(scale * (to_scene ? -surface.aspheric[i] : surface.aspheric[i]));
  return asphere;
}

}  // namespace plenoflame
