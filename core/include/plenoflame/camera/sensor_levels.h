#pragma once
#include "plenoflame/scene/sensor_spec.h"

namespace plenoflame {

/// The sensor with its gain and black level as numbers. A gain of 0 becomes the gain at which the
/// full well is the largest digital number. A black level of 0 becomes the smallest integer with
/// room for kReadNoiseRoom standard deviations of the read noise below it. It is at most half of
/// the range. Without this room the converter, which gives no negative numbers, would cut off half
/// of the noise and raise the mean of dark pixels.
SensorSpec resolved_levels(SensorSpec sensor);

/// Standard deviations of the read noise for which a black level of 0 makes room.
inline constexpr double kReadNoiseRoom = 5;

/// Counts from which on a pixel is full, at most the largest number. The full well is reduced by
/// five standard deviations of the read noise. @param levels resolved
double full_counts(const SensorSpec& levels);

/// Increase [electrons] of the mean of a pixel without light, because the converter gives no
/// negative numbers. It is g times the sum over k = 1, 2, ... of the probability that the rounded
/// number is -k or less. Includes the dark current of sensor.exposure_time.
double dark_pixel_excess(const SensorSpec& sensor);

}  // namespace plenoflame
