#include "plenoflame/lightfield/ground_truth.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <optional>
#include <sstream>
#include <vector>

#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

Vec2 pixel_of(const Camera& camera, Vec2 sensor_point) {
  return camera.image_point(sensor_point);
}

/// The point where a ray meets the plane z of the camera frame.
Vec2 at_plane(const Ray& ray, double z) {
  const double t = (z - ray.origin.z) / ray.direction.z;
  return {ray.origin.x + t * ray.direction.x, ray.origin.y + t * ray.direction.y};
}

/// The sensor point s from which the ray towards aim(s) leaves through `target` [camera frame].
template <class Aim>
std::optional<Vec2> find_sensor_point(const Camera& camera, std::optional<LensIndex> lens,
                                      const Aim& aim, Vec3 target, Vec2 start) {
  const double step = 1e-3 * camera.spec().sensor.pixel_pitch;
  const auto miss = [&](Vec2 s) -> std::optional<Vec2> {
    const Camera::Path path = camera.trace(s, lens, aim(s));
    if (path.status.status != RayStatus::reached) return std::nullopt;
    return at_plane(path.exit, target.z) - Vec2{target.x, target.y};
  };
  Vec2 s = start;
  for (int i = 0; i < 12; ++i) {
    const auto at = miss(s), right = miss(s + Vec2{step, 0}), up = miss(s + Vec2{0, step});
    if (!at || !right || !up) return std::nullopt;
    const Vec2 u = (1 / step) * (*right - *at), v = (1 / step) * (*up - *at);
    const double determinant = u.x * v.y - v.x * u.y;
    if (determinant == 0) return std::nullopt;
    const Vec2 change{(v.y * at->x - v.x * at->y) / determinant,
                      (u.x * at->y - u.y * at->x) / determinant};
    s = s - change;
    if (length(change) < 1e-9 * camera.spec().sensor.pixel_pitch) return s;
  }
  return std::nullopt;
}

/// The area where light of a point meets the array's front: the middle of the beam and its half
/// width.
struct Footprint {
  Vec2 lower{kInfinity, kInfinity}, upper{-kInfinity, -kInfinity};
  void add(Vec2 p) {
    lower = {std::min(lower.x, p.x), std::min(lower.y, p.y)};
    upper = {std::max(upper.x, p.x), std::max(upper.y, p.y)};
  }
  bool empty() const { return !(lower.x <= upper.x); }
};

Footprint footprint(const Camera& camera, Vec3 point) {
  constexpr int kRings = 12, kSpokes = 24;
  const FirstOrder& lens = camera.lens_first_order();
  const double pupil = 0.65 * lens.entrance_pupil_diameter;
  Footprint result;
  // In the frame of the main lens; places on the array are those of the camera.
  const RigidTransform& pose = camera.lens_pose();
  point = pose.inverse().point(point);
  const auto add = [&](const Ray& ray) {
    result.add(
        at_plane({pose.point(ray.origin), pose.direction(ray.direction)}, camera.array_front()));
  };
  for (int ring = 0; ring <= kRings; ++ring)
    for (int spoke = 0; spoke < kSpokes; ++spoke) {
      const double r = pupil * ring / kRings, angle = 6.283185307179586 * spoke / kSpokes;
      const Vec3 target{r * std::cos(angle), r * std::sin(angle), -lens.entrance_pupil};
      const Vec3 direction = normalize(target - point);
      if (direction.z >= 0) continue;
      Ray ray{point, direction};
      double ratio = 1;
      if (camera.distortion().present() && !camera.distortion().to_lens(ray, ratio)) continue;
      if (camera.ideal_lens()) {
        const IdealLens& ideal = camera.ideal();
        const Vec2 height = at_plane(ray, ideal.front_principal);
        const Vec2 slope =
            Vec2{ray.direction.x / ray.direction.z, ray.direction.y / ray.direction.z} +
            (1 / ideal.focal_length) * height;
        add({{height.x, height.y, ideal.rear_principal}, -normalize({slope.x, slope.y, 1})});
        continue;
      }
      if (camera.lens().trace_to_sensor(ray).status == RayStatus::reached) add(ray);
    }
  return result;
}

/// The part of a footprint that lies before the sensor and as far beside it as light can go
/// between array and sensor.
Footprint near_sensor(const Camera& camera, Footprint beam) {
  constexpr double kSteepest = 10;  // tangent of 84 degrees
  const Vec2 corner = camera.sensor_point(0, 0);
  const double room = kSteepest * (camera.aim_plane(0) - camera.sensor());
  const Vec2 half = {std::fabs(corner.x) + room, std::fabs(corner.y) + room};
  beam.lower = {std::max(beam.lower.x, -half.x), std::max(beam.lower.y, -half.y)};
  beam.upper = {std::min(beam.upper.x, half.x), std::min(beam.upper.y, half.y)};
  return beam;
}

/// The part of a footprint whose microlenses can have images on the sensor: those that rays from
/// the exit pupil to the sensor meet.
Footprint towards_sensor(const Camera& camera, Footprint beam) {
  const double exit = camera.exit_pupil(), plane = camera.aim_plane(0);
  if (!std::isfinite(exit) || !(exit > plane)) return near_sensor(camera, beam);
  // Pupils of real lenses move and grow off axis, and misaligned parts a little: with room to
  // spare.
  constexpr double kRoom = 1.1;
  const double share = (exit - plane) / (exit - camera.sensor());  // of the way from the pupil
  const double pupil = kRoom * (1 - share) * camera.lens_first_order().exit_pupil_diameter +
                       3 * longest_pitch(camera.spec().array);
  const Vec2 corner = camera.sensor_point(0, 0), foot = camera.foot();
  const Vec2 half = {kRoom * share * (std::fabs(corner.x) + std::fabs(foot.x)) + pupil,
                     kRoom * share * (std::fabs(corner.y) + std::fabs(foot.y)) + pupil};
  beam.lower = {std::max(beam.lower.x, foot.x - half.x), std::max(beam.lower.y, foot.y - half.y)};
  beam.upper = {std::min(beam.upper.x, foot.x + half.x), std::min(beam.upper.y, foot.y + half.y)};
  return beam;
}

/// Calls task(first, last) for parts of a range, side by side, and tells the progress.
template <class Task>
void in_parts(std::size_t count, std::size_t part, const Execution& execution, const Task& task) {
  const std::size_t parts = (count + part - 1) / part;
  std::mutex mutex;
  std::size_t ended = 0;
  const bool done = parallel_for(execution, parts, [&](std::size_t k, int) {
    task(k * part, std::min(count, (k + 1) * part));
    if (!execution.progress) return;
    const std::lock_guard lock(mutex);
    Progress progress;
    progress.fraction = static_cast<double>(++ended) / static_cast<double>(parts);
    execution.progress(progress);
  });
  if (!done) throw Cancelled();
}

}  // namespace

std::vector<MicroImageTruth> micro_image_truth(const MicroImages& images) {
  const Camera& camera = images.camera();
  const SensorSpec& sensor = camera.spec().sensor;
  // Micro-images lie farther out than their lenses, by less than the sensor's own size.
  const double margin = 3 * longest_pitch(camera.spec().array);
  const Vec2 corner = camera.sensor_point(0, 0);
  std::vector<MicroImageTruth> truth;
  for (const LensIndex lens : camera.lattice().within({-corner.x - margin, -corner.y - margin},
                                                      {corner.x + margin, corner.y + margin})) {
    const MicroImages::Place place = images.place(lens);
    if (place.dark) continue;
    const Vec2 centre = pixel_of(camera, place.centre);
    const double radius = place.radius / sensor.pixel().x,
                 radius_y = place.radius / sensor.pixel().y;
    if (centre.x + radius < 0 || centre.y + radius_y < 0 || centre.x - radius > sensor.columns ||
        centre.y - radius_y > sensor.rows)
      continue;
    truth.push_back({lens, place.type, centre, radius});
  }
  return truth;
}

std::vector<PointTruth> project_point(const Camera& camera, Vec3 world,
                                      const Execution& execution) {
  const Vec3 point = camera.to_world().inverse().point(world);
  std::vector<PointTruth> images;
  Footprint beam = footprint(camera, point);
  if (beam.empty()) return images;
  const SensorSpec& sensor = camera.spec().sensor;
  const auto add = [&](LensIndex lens, int type, Vec2 s) {
    const Vec2 pixel = pixel_of(camera, s);
    if (pixel.x >= 0 && pixel.y >= 0 && pixel.x <= sensor.columns && pixel.y <= sensor.rows)
      images.push_back({lens, type, pixel});
  };
  if (!camera.has_array()) {
    const double exit = camera.exit_pupil(), plane = camera.aim_plane(0);
    const Vec2 middle{0.5 * (beam.lower.x + beam.upper.x), 0.5 * (beam.lower.y + beam.upper.y)};
    const double share = std::isfinite(exit) ? (exit - plane) / (exit - camera.sensor()) : 1;
    const auto through_pupil = [&](Vec2 s) { return camera.foot() + share * (s - camera.foot()); };
    if (const auto s = find_sensor_point(camera, std::nullopt, through_pupil, point, middle))
      add({}, 0, *s);
    return images;
  }
  const double reach = longest_pitch(camera.spec().array);
  beam = towards_sensor(camera, beam);
  const std::vector<LensIndex> lenses = camera.lattice().within(
      {beam.lower.x - reach, beam.lower.y - reach}, {beam.upper.x + reach, beam.upper.y + reach});
  std::vector<std::optional<Vec2>> found(lenses.size());
  in_parts(lenses.size(), 256, execution, [&](std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k) {
      const Vec3 place = camera.lens_place(lenses[k]);
      const Vec2 centre{place.x, place.y};
      const double exit = camera.exit_pupil();
      const Vec2 start = std::isfinite(exit)
                             ? camera.foot() + ((exit - camera.sensor()) / (exit - place.z)) *
                                                   (centre - camera.foot())
                             : centre;
      found[k] = find_sensor_point(
          camera, lenses[k], [&](Vec2) { return centre; }, point, start);
    }
  });
  for (std::size_t k = 0; k < lenses.size(); ++k)
    if (found[k]) add(lenses[k], camera.lattice().type(lenses[k]), *found[k]);
  return images;
}

void add_chief_rays(const MicroImages& images, LightField& light_field,
                    const Execution& execution) {
  const Camera& camera = images.camera();
  const PixelWindow& window = light_field.window;
  const char* const names[] = {"chief.x", "chief.y", "chief.z", "chief.dx", "chief.dy", "chief.dz"};
  Image* layers[6];
  for (int i = 0; i < 6; ++i) {
    Image& image = light_field.layers[names[i]];
    image = Image(window.width, window.height);
    layers[i] = &image;
  }
  const double exit = camera.exit_pupil();
  const double scale = std::isfinite(exit) ? (exit - camera.array_back()) / (exit - camera.sensor())
                                           : 1;  // sensor point to the microlens before it
  const auto fill = [&](int row) {
    for (int column = 0; column < window.width; ++column) {
      const Vec2 s = camera.sensor_point(window.x + column + 0.5, window.y + row + 0.5);
      const MicroImages::Place place =
          images.place(camera.lattice().nearest(camera.foot() + scale * (s - camera.foot())));
      float values[6];
      std::fill(values, values + 6, std::numeric_limits<float>::quiet_NaN());
      if (!place.dark && length(s - place.centre) <= place.radius) {
        Ray ray;
        if (camera.misaligned()) {  // by itself: the tables are those of the aligned camera
          const Vec3 middle = camera.lens_place(place.lens);
          const Camera::Path path = camera.trace(s, place.lens, {middle.x, middle.y});
          if (path.status.status != RayStatus::reached) {
            for (Image* layer : layers)
              layer->at(column, row) = std::numeric_limits<float>::quiet_NaN();
            continue;
          }
          const Vec2 front = at_plane(path.exit, 0);
          ray = {{front.x, front.y, 0}, path.exit.direction};
        } else {
          const MicroImages::Line line = images.chief_ray(place, s);
          ray = {{line.position.x, line.position.y, 0}, normalize({line.slope.x, line.slope.y, 1})};
        }
        const Vec3 origin = camera.to_world().point(ray.origin);
        const Vec3 direction = camera.to_world().direction(ray.direction);
        const double exact[] = {origin.x,    origin.y,    origin.z,
                                direction.x, direction.y, direction.z};
        for (int i = 0; i < 6; ++i) values[i] = static_cast<float>(exact[i]);
      }
      for (int i = 0; i < 6; ++i) layers[i]->at(column, row) = values[i];
    }
  };
  in_parts(static_cast<std::size_t>(window.height), 16, execution,
           [&](std::size_t first, std::size_t last) {
             for (std::size_t row = first; row < last; ++row) fill(static_cast<int>(row));
           });
}

std::string micro_image_csv(const std::vector<MicroImageTruth>& truth, const CameraSpec& camera) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(10);
  text << "q,r,type,column,row,radius\n";
  for (const MicroImageTruth& t : truth)
    text << t.lens.q << ',' << t.lens.r << ','
         << camera.array.types[static_cast<std::size_t>(t.type)].name << ',' << t.centre.x << ','
         << t.centre.y << ',' << t.radius << '\n';
  return text.str();
}

}  // namespace plenoflame
