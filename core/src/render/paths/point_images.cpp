#include "plenoflame/render/point_images.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "render/visibility/aperture_cone.h"

namespace plenoflame {
namespace {

struct Gathered {
  double weight = 0, x = 0, y = 0, squares = 0;  ///< in pixels
};

using Lenses = std::map<std::pair<int, int>, Gathered>;

/// A point set in the unit square: Roberts' generalised golden ratio.
double fraction_of(double value) {
  return value - std::floor(value);
}

/// @return the weight of the arriving light
double add(const Camera::Arrival& arrival, const Camera& camera, Lenses& lenses) {
  const auto [x, y] = camera.image_point(arrival.sensor_point);
  const LensIndex lens = arrival.lens.value_or(LensIndex{});
  Gathered& sum = lenses[{lens.q, lens.r}];
  const double w = arrival.etendue_ratio;
  sum.weight += w;
  sum.x += w * x;
  sum.y += w * y;
  sum.squares += w * (x * x + y * y);
  return w;
}

}  // namespace

std::vector<PointImage> point_images(const Camera& camera, Vec3 world, int rays,
                                     const LightStop& stopped) {
  std::vector<PointImage> images;
  const ApertureCone cone(camera);
  const Vec3 point = camera.to_world().inverse().point(world);
  if (!cone.in_front(point)) return images;
  const SensorSpec& sensor = camera.spec().sensor;
  Lenses lenses;
  std::vector<Camera::Arrival> arrivals;
  double total = 0;
  for (int i = 0; i < rays; ++i) {
    const ApertureCone::Direction way = cone.draw(point, fraction_of(0.5 + 0.7548776662466927 * i),
                                                  fraction_of(0.5 + 0.5698402909980532 * i));
    if (!(way.solid_angle > 0)) continue;
    arrivals.clear();
    camera.trace_from_scene({point, way.direction}, arrivals);
    if (arrivals.empty()) continue;
    if (stopped && stopped(camera.to_world().direction(way.direction),
                           cone.distance_to_front(point, way.direction)))
      continue;
    for (const Camera::Arrival& arrival : arrivals) total += add(arrival, camera, lenses);
  }
  for (const auto& [index, sum] : lenses) {
    if (!(sum.weight > 0)) continue;
    PointImage image;
    image.lens = {index.first, index.second};
    image.type = camera.has_array() ? camera.lattice().type(image.lens) : -1;
    image.column = sum.x / sum.weight;
    image.row = sum.y / sum.weight;
    const double square =
        sum.squares / sum.weight - image.column * image.column - image.row * image.row;
    image.spread = std::sqrt(std::max(0.0, square) + 2 * sensor.blur * sensor.blur);
    image.share = sum.weight / total;
    if (image.column >= 0 && image.column < sensor.columns && image.row >= 0 &&
        image.row < sensor.rows)
      images.push_back(image);
  }
  return images;
}

}  // namespace plenoflame
