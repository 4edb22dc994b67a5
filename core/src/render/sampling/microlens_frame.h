#pragma once
#include "plenoflame/camera/pupil_sampling.h"
#include "render/sampling/backward_kernel.h"

namespace plenoflame {

/// The kernels' data of a microlens at `place`, in the direction `field` from the optical axis.
/// @param node entry of the table there @param ideal_array the microlens has one aperture
template <class Real>
KernelFrame<Real> microlens_frame(const PupilTable& table, const PupilNode& node, Vec2 place,
                                  Vec2 field, bool ideal_array);

/// Adds data that locate the sides of a lens' apertures exactly. Adds nothing for circular
/// apertures, or if lenses of the type differ. @param type of the lens
template <class Real>
void add_faces(const Camera& camera, int type, KernelFrame<Real>& frame);

/// A column that leaves a disc with radius `bound` uncut.
CutColumn whole_aperture(double bound);

}  // namespace plenoflame
