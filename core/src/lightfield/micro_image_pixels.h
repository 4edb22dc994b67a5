#pragma once
#include "lightfield/micro_image_kernel.h"
#include "plenoflame/base/isa.h"
#include "plenoflame/scene/sensor_spec.h"

namespace plenoflame {

/// The kernels of this instruction set.
struct MicroImageKernels {
  decltype(&baseline::white_light) white_light;
  decltype(&baseline::project) project;
};
MicroImageKernels micro_image_kernels(Isa isa);

/// [m] radius of a disc that holds a pixel, a little larger than needed.
inline double pixel_disc(const SensorSpec& sensor) {
  return sensor.square_pixels() ? 0.71 * sensor.pixel_pitch : 1.005 * sensor.pixel_reach();
}

}  // namespace plenoflame
