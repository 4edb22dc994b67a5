#pragma once
#include <cstddef>
#include <string>

#include "plenoflame/image/light_field.h"
#include "plenoflame/lightfield/pyrometry.h"
#include "plenoflame/measure/two_colour_light.h"
#include "plenoflame/scene/scene.h"

namespace plenoflame {

/// Temperatures from the colours that two filters of the pupil make, and what to write of them.
struct PupilPyrometry {
  TemperatureMap map;
  LightField picture;  ///< the map as a light field, a pixel for the area of a microlens
  LeftOutPixels left_out;
  double pixels[2] = {};  ///< of the sensor, for each of its pixels and each filter
};

/// @param channel number of the channel behind both filters
/// @param filters two names @throws InputError, UsageError
PupilPyrometry pupil_pyrometry(const LightField& field, const Scene& scene, std::size_t channel,
                               const std::string (&filters)[2], const AbsorptionSpectrum& law,
                               const PyrometrySettings& settings);

}  // namespace plenoflame
