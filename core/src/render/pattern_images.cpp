#include "plenoflame/render/pattern_images.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <utility>

#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"
#include "render/aperture_cone.h"

namespace plenoflame {
namespace {

struct Gathered {
  double weight = 0, x = 0, y = 0, squares = 0;  ///< in pixels
};

/// A point set in the unit square: Roberts' generalised golden ratio.
double fraction_of(double value) {
  return value - std::floor(value);
}

class PointImager {
 public:
  PointImager(const CompiledScene& scene, int rays)
      : scene_(scene),
        rays_(rays),
        cone_(scene.camera),
        to_camera_(scene.camera.to_world().inverse()) {}

  std::vector<PatternImage> images_of(const PatternPoint& point) const {
    std::vector<PatternImage> images;
    PatternImage image;
    image.point = point;
    image.in_camera = to_camera_.point(point.point);
    if (!cone_.in_front(image.in_camera)) return images;
    std::map<std::pair<int, int>, Gathered> lenses;
    std::vector<Camera::Arrival> arrivals;
    double total = 0;
    for (int i = 0; i < rays_; ++i) {
      const ApertureCone::Direction way =
          cone_.draw(image.in_camera, fraction_of(0.5 + 0.7548776662466927 * i),
                     fraction_of(0.5 + 0.5698402909980532 * i));
      if (!(way.solid_angle > 0)) continue;
      arrivals.clear();
      scene_.camera.trace_from_scene({image.in_camera, way.direction}, arrivals);
      if (arrivals.empty()) continue;
      const Ray ray{point.point, scene_.camera.to_world().direction(way.direction)};
      const double end = cone_.distance_to_front(image.in_camera, way.direction);
      if (scene_.surfaces->occluded(ray, 0, end, {point.surface, 0})) continue;
      for (const Camera::Arrival& arrival : arrivals) total += add(arrival, lenses);
    }
    for (const auto& [index, sum] : lenses) {
      if (!(sum.weight > 0)) continue;
      image.lens = {index.first, index.second};
      image.type = scene_.camera.has_array() ? scene_.camera.lattice().type(image.lens) : -1;
      image.column = sum.x / sum.weight;
      image.row = sum.y / sum.weight;
      const double square =
          sum.squares / sum.weight - image.column * image.column - image.row * image.row;
      image.spread = std::sqrt(std::max(0.0, square));
      image.share = sum.weight / total;
      const SensorSpec& sensor = scene_.camera.spec().sensor;
      if (image.column >= 0 && image.column < sensor.columns && image.row >= 0 &&
          image.row < sensor.rows)
        images.push_back(image);
    }
    return images;
  }

 private:
  double add(const Camera::Arrival& arrival,
             std::map<std::pair<int, int>, Gathered>& lenses) const {
    const SensorSpec& sensor = scene_.camera.spec().sensor;
    const double x = 0.5 * sensor.columns - arrival.sensor_point.x / sensor.pixel_pitch;
    const double y = 0.5 * sensor.rows - arrival.sensor_point.y / sensor.pixel_pitch;
    const LensIndex lens = arrival.lens.value_or(LensIndex{});
    Gathered& sum = lenses[{lens.q, lens.r}];
    const double w = arrival.etendue_ratio;
    sum.weight += w;
    sum.x += w * x;
    sum.y += w * y;
    sum.squares += w * (x * x + y * y);
    return w;
  }

  const CompiledScene& scene_;
  int rays_;
  ApertureCone cone_;
  RigidTransform to_camera_;
};

}  // namespace

std::vector<PatternImage> pattern_images(const CompiledScene& scene, int rays,
                                         const Execution& execution) {
  const std::vector<PatternPoint> points =
      scene.surfaces ? scene.surfaces->pattern_points() : std::vector<PatternPoint>{};
  if (points.empty())
    throw InputError(
        "the scene has no checkerboard or dot grid: give a plane or disc a texture of kind "
        "\"checkerboard\" or \"dots\"");
  const PointImager imager(scene, rays);
  std::vector<std::vector<PatternImage>> found(points.size());
  if (!parallel_for(execution, points.size(),
                    [&](std::size_t i, int) { found[i] = imager.images_of(points[i]); }))
    throw Cancelled();
  std::vector<PatternImage> images;
  for (const auto& part : found) images.insert(images.end(), part.begin(), part.end());
  return images;
}

void write_pattern_images(const std::string& path, const CompiledScene& scene,
                          const std::vector<PatternImage>& images) {
  std::string text =
      "surface,name,column,row,x_m,y_m,z_m,camera_x_m,camera_y_m,camera_z_m,lens_q,lens_r,type,"
      "image_column,image_row,spread_pixels,share\n";
  for (const PatternImage& image : images) {
    std::string name = scene.scene.surfaces[static_cast<std::size_t>(image.point.surface)].name;
    for (char& c : name)
      if (c == '"' || c == '\n' || c == '\r') c = '\'';
    const Vec3 p = image.point.point, q = image.in_camera;
    text += fmt::format("{},\"{}\",{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n",
                        image.point.surface, name, image.point.column, image.point.row, p.x, p.y,
                        p.z, q.x, q.y, q.z, image.lens.q, image.lens.r, image.type, image.column,
                        image.row, image.spread, image.share);
  }
  write_file(path, text);
}

}  // namespace plenoflame
