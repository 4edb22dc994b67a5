#pragma once
#include "optics/shape_kernel.h"
#include "plenoflame/scene/main_lens_spec.h"

namespace plenoflame {

/// The shape of a surface as the kernels take it. For rays towards the scene the sag changes its
/// sign with the direction of propagation.
template <class Real>
KernelShape<Real> kernel_shape(const SurfaceSpec& surface, bool to_scene);

}  // namespace plenoflame
