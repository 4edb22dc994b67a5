#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plenoflame/base/units.h"
#include "plenoflame/optics/first_order.h"
#include "plenoflame/optics/surface_shape.h"
#include "plenoflame/scene/cameras.h"
#include "scene/schema/nearest.h"
#include "scene/validation/issues.h"

namespace plenoflame {
namespace {

constexpr double kSuspiciousMaximum = 200;  // [K] no flame is that cold

/// Reach of the camera in front of its front vertex: the rim of a concave front surface [m].
double camera_front(const CameraSpec& camera) {
  if (camera.lens.surfaces.empty()) return 0;
  return reach_to_scene(camera.lens.surfaces.front());
}

/// @param nearest, farthest distance of the flame from the front vertex along the optical axis [m]
void check_depth(const CameraSpec& camera, const std::string& what, double nearest, double farthest,
                 const std::string& key, Issues& issues) {
  if (nearest <= camera_front(camera)) {
    issues.error(
        key, farthest <= 0
                 ? fmt::format("{} lies behind the front of {}; move it to where the camera looks",
                               what, camera_in_words(camera))
                 : fmt::format("{} reaches into {}: it extends from {} to {} in front of the "
                               "front vertex; "
                               "move it away",
                               what, camera_in_words(camera), short_length(nearest),
                               short_length(farthest)));
    return;
  }
  const double focal_point = -first_order(camera.lens).front_focal_distance;
  if (nearest < focal_point)
    issues.warning(
        key,
        fmt::format(
            "{} begins {} in front of the front vertex{}, inside the front focal point at {}: the "
            "image of that part is virtual and far out of focus",
            what, short_length(nearest),
            camera.name.empty() ? "" : " of " + camera_in_words(camera),
            short_length(focal_point)));
}

/// Half the extent of an ellipsoid along a direction [m].
double support(const Mat3& rotation, Vec3 semi_axes, Vec3 direction) {
  const Vec3 d = transpose(rotation) * direction;
  return length({semi_axes.x * d.x, semi_axes.y * d.y, semi_axes.z * d.z});
}

void check_layered(const Scene& scene, const FlameSpec& flame, const std::string& path,
                   const std::string& what, bool camera_is_sound, Issues& issues) {
  if (flame.layers.empty()) {
    if (!flame.file.empty())
      issues.error(path + ".file", what +
                                       " names a file, but is of kind \"layered\"; set kind = "
                                       "\"vdb\" to read the file");
    else
      issues.error(
          path,
          what +
              " has no layers; list them as [[flames.layers]], or set preset = \"paper-layered\"");
    return;
  }
  if (!flame.file.empty())
    issues.warning(path + ".file", what + " is layered, so its file is not used");
  if (!camera_is_sound) return;
  const Mat3 rotation = rotation_xyz(flame.rotation);
  const Vec3 axis = normalize(scene.camera.look_direction);
  double nearest = kInfinity, farthest = -kInfinity, hottest = 0;
  for (const EllipsoidSpec& layer : flame.layers) {
    hottest = std::max(hottest, layer.temperature);
    const Vec3 centre = flame.position + rotation * (flame.scale * layer.centre);
    const double distance = dot(axis, centre - scene.camera.position);
    const double half = support(rotation, flame.scale * layer.semi_axes, axis);
    nearest = std::min(nearest, distance - half);
    farthest = std::max(farthest, distance + half);
  }
  check_depth(scene.camera, what, nearest, farthest, path + ".position", issues);
  if (hottest < kSuspiciousMaximum)
    issues.warning(path + ".layers",
                   fmt::format("{} is {} at most, too cold to be seen; is that in degC?", what,
                               readable_quantity(hottest, Dimension::temperature)));
}

void check_unit(const GridSpec& grid, Dimension dimension, const std::string& path,
                Issues& issues) {
  if (grid.unit.empty()) return;
  const auto units = accepted_units(dimension);
  if (std::find(units.begin(), units.end(), grid.unit) != units.end()) return;
  const bool fraction = dimension == Dimension::absorption;
  if (fraction && (grid.unit == "1" || grid.unit == "ppm")) return;  // a volume fraction
  std::string list;
  for (const std::string& unit : units) list.append(list.empty() ? "" : ", ").append(unit);
  issues.error(path,
               fmt::format("{} is {}; it must be one of {}", path, quote_for_message(grid.unit),
                           fraction ? list + ", or 1 or ppm for soot" : list));
}

}  // namespace

void check_flames(const Scene& scene, bool camera_is_sound, Issues& issues) {
  bool background = false;
  for (const LightSpec& light : scene.lights)
    background = background || light.kind == LightKind::environment;
  if (scene.flames.empty() && scene.surfaces.empty() && !background)
    issues.warning("flames", "the scene has no flame, so its picture is black",
                   IssueCode::no_flame);
  for (std::size_t i = 0; i < scene.flames.size(); ++i) {
    const FlameSpec& flame = scene.flames[i];
    const std::string path = fmt::format("flames[{}]", i);
    const std::string what =
        flame.name.empty() ? fmt::format("flame {}", i) : "flame " + quote_for_message(flame.name);
    check_unit(flame.temperature, Dimension::temperature, path + ".temperature.unit", issues);
    check_unit(flame.absorption, Dimension::absorption, path + ".absorption.unit", issues);
    check_flame_time(flame, path, what, issues);
    if (flame.kind == FlameKind::layered) {
      check_layered(scene, flame, path, what, camera_is_sound, issues);
      continue;
    }
    if (flame.file.empty())
      issues.error(path, what + " is of kind \"vdb\" and needs a file; set file = \"NAME.vdb\"");
    if (!flame.layers.empty())
      issues.warning(path + ".layers", what + " comes from a file, so its layers are not used");
  }
}

std::vector<SceneIssue> check_flame_box(const CameraSpec& camera, const std::string& flame_name,
                                        const Box& world, const std::string& key,
                                        const PositionMap& positions) {
  Issues issues(positions);
  if (world.empty()) return {};
  const Vec3 axis = normalize(camera.look_direction);
  const Vec3 half = 0.5 * (world.upper - world.lower);
  const double distance = dot(axis, 0.5 * (world.upper + world.lower) - camera.position);
  const double reach =
      half.x * std::fabs(axis.x) + half.y * std::fabs(axis.y) + half.z * std::fabs(axis.z);
  check_depth(camera, "flame " + quote_for_message(flame_name), distance - reach, distance + reach,
              key, issues);
  return issues.take();
}

}  // namespace plenoflame
