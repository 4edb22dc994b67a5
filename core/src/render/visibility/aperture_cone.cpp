#include "render/visibility/aperture_cone.h"

#include <algorithm>
#include <cmath>

#include "plenoflame/base/constants.h"
#include "plenoflame/optics/surface_shape.h"
#include "sampling/directions.h"

namespace plenoflame {
namespace {

constexpr double kSphereMargin = 1 + 1e-9;  ///< on the sphere's radius, for rounding

}  // namespace

ApertureCone::ApertureCone(const Camera& camera) {
  if (!camera.ideal_lens()) {
    const SurfaceSpec& first = camera.spec().lens.surfaces.front();
    const double height = 0.5 * first.diameter;
    const double depth = surface_sag(first, {height, 0});  // of the rim behind the vertex
    // A cap up to a hemisphere is inside of the sphere around the middle of its rim. For other
    // shapes the loop checks this.
    centre_ = {0, 0, -depth};
    radius_ = std::max(height, std::fabs(depth));
    front_ = reach_to_scene(first);
    if (is_aspheric(first)) {
      constexpr int kSteps = 256;
      for (const Vec2 place : places_on(is_round(first), height, kSteps))
        radius_ = std::max(radius_, std::hypot(length(place), surface_sag(first, place) - depth));
      radius_ += height / kSteps;  // the slope is below one where rays enter
    }
    radius_ *= kSphereMargin;
    widen_by_distortion(camera);
    move_with(camera);
    return;
  }
  pupil_ = true;
  // A ray has the height h at the front principal plane and the slope s in the scene. It passes if
  // |a h + b s| is within the stop. This is a disc; rays from its centre have a h = -b s.
  const IdealLens& lens = camera.ideal();
  const double a = lens.stop_height + lens.stop_slope / lens.focal_length, b = lens.stop_slope;
  if (std::fabs(a) * 1e9 * lens.focal_length < std::fabs(b)) {
    telecentric_ = kSphereMargin * lens.stop_radius / std::fabs(b);
    // Directions refer to the camera; a tilted lens needs a wider range of them.
    if (camera.lens_moved())
      telecentric_ = std::tan(std::atan(telecentric_) + length(camera.spec().lens.tilt));
    return;
  }
  centre_ = {0, 0, lens.front_principal + b / a};
  radius_ = kSphereMargin * lens.stop_radius / std::fabs(a);
  move_with(camera);
}

/// Distortion keeps the place of rays in the entrance pupil's plane and shifts them at the front
/// surface.
void ApertureCone::widen_by_distortion(const Camera& camera) {
  const LensDistortion& distortion = camera.distortion();
  if (!distortion.present()) return;
  radius_ +=
      distortion.largest_bend(kInfinity) * (std::fabs(distortion.pupil() - centre_.z) + radius_);
}

/// Moves the cone with a decentred or tilted main lens.
void ApertureCone::move_with(const Camera& camera) {
  if (!camera.lens_moved()) return;
  centre_ = camera.lens_pose().point(centre_);
  if (pupil_) return;
  // The foremost point of the rim, or of the lens in front of it.
  const Vec3 axis = camera.lens_pose().direction({0, 0, 1});
  front_ = std::max(front_, front_ * axis.z + radius_ * std::hypot(axis.x, axis.y));
}

ApertureCone::Direction ApertureCone::draw(Vec3 point, double u, double v) const {
  Vec3 axis{0, 0, -1};
  double versine = 1;  // of the cone: a hemisphere unless the point is outside of the sphere
  if (telecentric_ > 0) {
    const double secant = std::hypot(1.0, telecentric_);
    versine = telecentric_ * telecentric_ / (secant * (1 + secant));
  } else {
    const Vec3 to_centre = centre_ - point;
    const double distance = length(to_centre);
    if (distance > radius_) {
      const double sine = radius_ / distance;
      versine = sine * sine / (1 + std::sqrt((1 - sine) * (1 + sine)));
      axis = (1 / distance) * to_centre;
    }
  }
  Direction result;
  result.direction = cone_direction(axis, u * versine, v);
  result.solid_angle = 2 * constants::pi * versine;
  if (!(result.direction.z < 0)) {
    if (pupil_ && result.direction.z > 0)
      result.direction = -result.direction;
    else
      result.solid_angle = 0;
  }
  return result;
}

}  // namespace plenoflame
