#pragma once
#include "plenoflame/camera/pupil_sampling.h"
#include "render/backward_kernel.h"

namespace plenoflame {

/// What the kernels know of a microlens that stands at `place`, in the direction `field` from the
/// optical axis. @param node the table's there @param ideal_array the microlens has one aperture
template <class Real>
KernelPatch<Real> microlens_patch(const PupilTable& table, const PupilNode& node, Vec2 place,
                                  Vec2 field, bool ideal_array);

/// Cuts nothing of a disc with radius `bound`.
CutColumn whole_aperture(double bound);

}  // namespace plenoflame
