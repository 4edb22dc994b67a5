#include "plenoflame/camera/sensor_levels.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace plenoflame {

SensorSpec resolved_levels(SensorSpec sensor) {
  const double largest = std::ldexp(1.0, sensor.bits) - 1;
  const double room = kReadNoiseRoom * sensor.read_noise;
  if (!(sensor.black_level > 0)) {
    // If the gain fills the range, (largest - black) * gain = full well and black * gain >= room
    // hold together. Rounding adds half a digital number of room.
    const double numbers =
        sensor.gain > 0 ? room / sensor.gain : room * largest / (sensor.full_well + room);
    sensor.black_level =
        std::min(std::max(0.0, std::ceil(numbers - 0.5)), std::floor(0.5 * largest));
  }
  if (!(sensor.gain > 0)) sensor.gain = sensor.full_well / (largest - sensor.black_level);
  return sensor;
}

double full_counts(const SensorSpec& levels) {
  const double well =
      std::max(0.5 * levels.full_well, levels.full_well - 5 * levels.read_noise) / levels.gain;
  return std::min(levels.black_level + well, std::ldexp(1.0, levels.bits) - 1);
}

double dark_pixel_excess(const SensorSpec& sensor) {
  if (!(sensor.read_noise > 0)) return 0;
  const SensorSpec levels = resolved_levels(sensor);
  const double dark = sensor.dark_current * sensor.exposure_time;
  const double step = levels.gain / sensor.read_noise;
  const double room = (levels.black_level * levels.gain + dark) / sensor.read_noise;
  const auto below = [](double z) { return 0.5 * std::erfc(z / std::sqrt(2.0)); };
  // For fine steps the sum is the midpoint rule of an integral, phi(z) - z Phi(-z).
  if (step < 0.1) {
    const double density = std::exp(-0.5 * room * room) / std::sqrt(2 * std::numbers::pi);
    return sensor.read_noise * (density - room * below(room));
  }
  double sum = 0;
  for (double z = room + 0.5 * step; z < 10; z += step) sum += below(z);
  return levels.gain * sum;
}

}  // namespace plenoflame
