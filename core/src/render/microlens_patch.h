#pragma once
#include <algorithm>

#include "plenoflame/camera/pupil_sampling.h"
#include "render/backward_kernel.h"

namespace plenoflame {

/// What the kernels know of a microlens that stands at `place`, in the direction `field` from the
/// optical axis. @param node the table's there @param ideal_array the microlens has one aperture
template <class Real>
KernelPatch<Real> microlens_patch(const PupilTable& table, const PupilNode& node, Vec2 place,
                                  Vec2 field, bool ideal_array);

/// The cut that cuts nothing of a disc with radius `bound`.
PixelCut whole_aperture(double bound);

template <class Real>
void set_cut(const PixelCut& cut, KernelPixel<Real>& pixel) {
  pixel.cut_middle = cut.middle;
  for (std::size_t half = 0; half < 2; ++half) {
    std::copy(cut.value[half].begin(), cut.value[half].end(), pixel.cut[half]);
    std::copy(cut.slope[half].begin(), cut.slope[half].end(), pixel.slope[half]);
  }
}

}  // namespace plenoflame
