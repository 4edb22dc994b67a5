#pragma once
#include "optics/kernel_types.h"
#include "plenoflame/scene/scene.h"

namespace plenoflame {

/// For rays towards the scene the sag changes its sign with the direction of propagation.
template <class Real>
KernelAsphere<Real> kernel_asphere(const SurfaceSpec& surface, bool to_scene) {
  KernelAsphere<Real> asphere{static_cast<Real>(surface.conic), {}};
  for (std::size_t i = 0; i < surface.aspheric.size() && i < kAsphericTerms; ++i)
    asphere.terms[i] = static_cast<Real>(to_scene ? -surface.aspheric[i] : surface.aspheric[i]);
  return asphere;
}

}  // namespace plenoflame
