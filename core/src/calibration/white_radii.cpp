#include "plenoflame/calibration/white_radii.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "plenoflame/base/error.h"

namespace plenoflame {

RadiiSlope radii_slope(const std::vector<RadiusObservation>& radii, double f_number) {
  struct Type {
    double count = 0, x = 0, y = 0;
  };
  std::map<std::size_t, Type> types;
  const auto x_of = [](const RadiusObservation& r) { return 1 / (r.f_number * r.f_number); };
  const auto y_of = [](const RadiusObservation& r) { return r.radius * r.radius; };
  for (const RadiusObservation& radius : radii) {
    Type& type = types[radius.type];
    type.count += 1;
    type.x += x_of(radius);
    type.y += y_of(radius);
  }
  double xx = 0, xy = 0, given = 0;
  for (const RadiusObservation& radius : radii) {
    const Type& type = types[radius.type];
    const double x = x_of(radius) - type.x / type.count, y = y_of(radius) - type.y / type.count;
    xx += x * x;
    xy += x * y;
    given += std::pow(2 * x * radius.radius * radius.error, 2);
  }
  if (!(xx > 0))
    throw InputError("radii of white micro-images at two apertures or more are needed");
  const double steep = xy / xx;
  if (!(steep > 0))
    throw InputError(
        "radii of white micro-images do not grow with the stop: are the f-numbers the pictures'?");
  RadiiSlope found;
  found.slope = std::sqrt(steep);
  const std::size_t last = types.rbegin()->first;
  found.blur.assign(last + 1, std::numeric_limits<double>::quiet_NaN());
  for (const auto& [number, type] : types)
    found.blur[number] = std::sqrt(std::max(0.0, (type.y - steep * type.x) / type.count));
  double squares = 0;
  for (const RadiusObservation& radius : radii) {
    const Type& type = types[radius.type];
    const double rest =
        y_of(radius) - type.y / type.count - steep * (x_of(radius) - type.x / type.count);
    squares += rest * rest;
  }
  const double freedom = static_cast<double>(radii.size()) - static_cast<double>(types.size()) - 1;
  const double variance = (freedom > 0 ? squares / freedom / xx : 0) + given / (xx * xx);
  found.relative_error = std::hypot(0.5 * std::sqrt(variance) / steep, f_number);
  return found;
}

double slope_of_radii(const CameraSpec& camera) {
  return 0.5 * camera.array.sensor_distance * camera.lens.focal_length /
         (camera.focus.lens_distance * camera.sensor.pixel_pitch);
}

void set_focal_lengths(CameraSpec& camera, const std::vector<double>& blur) {
  const double b = camera.array.sensor_distance, whole = 1 + b / camera.focus.lens_distance;
  for (std::size_t t = 0; t < camera.array.types.size() && t < blur.size(); ++t) {
    double& focal_length = camera.array.types[t].focal_length;
    const double part = 2 * blur[t] * camera.sensor.pixel_pitch / camera.array.diameter;
    const double found = b / (b / focal_length < whole ? whole - part : whole + part);
    if (std::isfinite(found) && found > 0) focal_length = found;
  }
}

}  // namespace plenoflame
