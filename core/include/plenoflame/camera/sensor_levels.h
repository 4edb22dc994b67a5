#pragma once
#include "plenoflame/scene/sensor_spec.h"

namespace plenoflame {

/// The sensor with its gain and black level as numbers. A gain of 0 becomes the one with which the
/// full well is the largest digital number. A black level of 0 becomes the least whole number below
/// which kReadNoiseRoom standard deviations of the read noise find room, at most half of the range:
/// the converter gives no negative numbers, and without room it would cut off half of the noise and
/// raise the mean of dark pixels.
SensorSpec resolved_levels(SensorSpec sensor);

/// Standard deviations of the read noise for which a black level of 0 makes room.
inline constexpr double kReadNoiseRoom = 5;

/// Counts from which on a pixel is full: the full well, of which the read noise may have taken five
/// standard deviations, or the largest number. @param levels resolved
double full_counts(const SensorSpec& levels);

/// By how much [electrons] the mean of a pixel without light is raised because the converter gives
/// no negative numbers: g times the sum over k = 1, 2, ... of the probability that the rounded
/// number is -k or less, with the dark current of sensor.exposure_time.
double dark_pixel_excess(const SensorSpec& sensor);

}  // namespace plenoflame
