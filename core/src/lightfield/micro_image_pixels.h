#pragma once
#include "lightfield/micro_image_kernel.h"
#include "plenoflame/base/isa.h"

namespace plenoflame {

/// The kernels of this instruction set.
struct MicroImageKernels {
  void (*white_light)(const KernelWhitePart* parts, int part_count, int side, int count,
                      const float* x, const float* y, float* out);
  bool (*project)(const KernelProjection&, const KernelSamples&);
};
MicroImageKernels micro_image_kernels(Isa isa);

}  // namespace plenoflame
