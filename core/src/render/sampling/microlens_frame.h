#pragma once
#include "plenoflame/camera/pupil_sampling.h"
#include "render/sampling/backward_kernel.h"

namespace plenoflame {

/// The kernels' data of a microlens that stands at `place`, in the direction `field` from the
/// optical axis. @param node the table's there @param ideal_array the microlens has one aperture
template <class Real>
KernelFrame<Real> microlens_frame(const PupilTable& table, const PupilNode& node, Vec2 place,
                                  Vec2 field, bool ideal_array);

/// Adds what the sides of a lens' apertures are found by exactly: nothing where they have none, or
/// where lenses of the type differ. @param type of the lens
template <class Real>
void add_faces(const Camera& camera, int type, KernelFrame<Real>& frame);

/// Cuts nothing of a disc with radius `bound`.
CutColumn whole_aperture(double bound);

}  // namespace plenoflame
