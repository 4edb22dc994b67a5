#include <algorithm>
#include <cmath>
#include <optional>

#include "plenoflame/base/error.h"
#include "plenoflame/base/units.h"
#include "plenoflame/camera/camera.h"
#include "plenoflame/optics/surface_shape.h"

namespace plenoflame {
namespace {

constexpr int kFocusRays = 1000;
constexpr double kWidestPupil = 0.65;  // of the paraxial diameter: no real pupil is wider
constexpr int kEdgeHalvings = 50;
constexpr double kGoldenAngle = 2.39996322972865332;  ///< [rad] Vogel's spiral: even over a disc

}  // namespace

double best_image_distance(const MainLensSpec& lens, double object_distance) {
  const FirstOrder paraxial = first_order(lens);
  if (lens.model == LensModel::ideal) return paraxial_image_distance(paraxial, object_distance);
  const LensSystem system(lens.surfaces);

  struct Behind {
    Vec2 place, slope;  ///< at the last vertex, per distance towards the sensor
  };
  /// The ray from the object on the axis through that place of the entrance pupil; none if it is
  /// blocked.
  const auto through = [&](Vec2 place) -> std::optional<Behind> {
    Ray ray;
    const Vec3 target{place.x, place.y, -paraxial.entrance_pupil};
    if (std::isinf(object_distance)) {
      ray = {{place.x, place.y, 1e-3 * paraxial.focal_length}, {0, 0, -1}};
    } else {
      const Vec3 object{0, 0, object_distance};
      ray = {object, normalize(target - object)};
      if (ray.direction.z >= 0) return std::nullopt;
    }
    if (system.trace_to_sensor(ray).status != RayStatus::reached) return std::nullopt;
    const Vec2 slope{-ray.direction.x / ray.direction.z, -ray.direction.y / ray.direction.z};
    const double way = ray.origin.z - system.vertices().back();
    return Behind{{ray.origin.x + slope.x * way, ray.origin.y + slope.y * way}, slope};
  };

  // Real pupils differ from the paraxial one, so the code searches for the edge along x. If the
  // lens is round, x represents all directions.
  const bool round = is_round(lens);
  const auto edge_along = [&](Vec2 direction) {
    double edge = 0, outside = kWidestPupil * paraxial.entrance_pupil_diameter;
    for (int i = 0; i < kEdgeHalvings; ++i) {
      const double middle = 0.5 * (edge + outside);
      (through(middle * direction) ? edge : outside) = middle;
    }
    return edge;
  };
  double edge = edge_along({1, 0});
  if (!round) edge = std::max(edge, edge_along({0, 1}));
  double sum_hs = 0, sum_ss = 0;
  for (int i = 0; i < kFocusRays; ++i) {
    const double height = edge * std::sqrt((i + 0.5) / kFocusRays);  // equal areas
    const double turn = round ? 0 : i * kGoldenAngle;
    const auto ray =
        through(round ? Vec2{height, 0} : Vec2{height * std::cos(turn), height * std::sin(turn)});
    if (!ray) continue;
    sum_hs += ray->place.x * ray->slope.x;
    sum_ss += ray->slope.x * ray->slope.x;
    if (round) continue;
    sum_hs += ray->place.y * ray->slope.y;
    sum_ss += ray->slope.y * ray->slope.y;
  }
  if (!(sum_ss > 0))
    throw InputError(
        "no ray from the axial object point gets through camera.lens: nothing to focus");
  return -sum_hs / sum_ss;
}

void Camera::solve_focus(std::vector<std::string>* warnings) {
  const FocusSpec& focus = spec_.focus;
  const ArraySpec& array = spec_.array;
  const FirstOrder& lens = lens_first_order_;
  if (focus.mode == FocusMode::distance) {
    lens_distance_ = focus.lens_distance;
  } else {
    if (!(focus.object_distance > 0))
      throw InputError("camera.focus.object_distance must be positive");
    const double front_focus = -lens.front_focal_distance;
    if (focus.object_distance <= front_focus)
      throw InputError("camera.focus.object_distance of " +
                       readable_quantity(focus.object_distance, Dimension::length) +
                       " is inside the front focal distance of " +
                       readable_quantity(front_focus, Dimension::length) +
                       ": the image is virtual, nothing can be focused there");
    const double image = focus.mode == FocusMode::paraxial
                             ? paraxial_image_distance(lens, focus.object_distance)
                             : best_image_distance(spec_.lens, focus.object_distance);
    lens_distance_ = image;
    if (array.present) {
      const auto named =
          std::find_if(array.types.begin(), array.types.end(),
                       [&](const MicrolensSpec& t) { return t.name == focus.conjugate; });
      const FirstOrder first = first_order(array, array.types.front());
      if (named != array.types.end()) {
        const FirstOrder type = first_order(array, *named);
        const double gap =
            array.sensor_distance +
            (array.measured_from == ArrayReference::principal_plane ? first.rear_principal : 0.0);
        const double sensor_distance = gap - type.rear_principal;
        const double sharp = 1.0 / (1.0 / type.focal_length - 1.0 / sensor_distance);
        if (!std::isfinite(sharp))
          throw InputError("microlens type \"" + named->name +
                           "\" is focused at infinity; focus the array or another type");
        lens_distance_ = image - type.front_principal + sharp;
      } else if (focus.conjugate == "array") {
        lens_distance_ = image - first.front_principal;
      } else {
        throw InputError("camera.focus.conjugate \"" + focus.conjugate +
                         "\" is neither \"array\" nor the name of a microlens type");
      }
    }
  }
  if (!(lens_distance_ > 0) || !std::isfinite(lens_distance_))
    throw InputError(std::string("the ") + (array.present ? "microlens array" : "sensor") +
                     " would stand inside the main lens (" +
                     readable_quantity(lens_distance_, Dimension::length) +
                     " behind its rear vertex); change camera.focus");
  if (warnings && focus.mode != FocusMode::distance && lens_distance_ > 100 * lens.focal_length)
    warnings->push_back("the image lies " + readable_quantity(lens_distance_, Dimension::length) +
                        " behind the lens: the object is close to its front focal plane");
}

}  // namespace plenoflame
