#include "camera/pupil/aperture_discs.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "camera/pupil/passing_edge.h"
#include "camera/pupil/pupil_field.h"

namespace plenoflame {
namespace {

constexpr double kDiscSafety = 1.2e-3;  ///< of the radius: margin of the far aperture
constexpr double kDiscRounding = 1e-5;  ///< of the near one, which is known exactly
constexpr int kDiscSteps = 16;          ///< sensor points from which apertures are sampled
constexpr int kFitSteps = 4;            ///< steps of the fit of the far aperture
constexpr double kTracedRoom = 1.3;     ///< factor on the excess of traced edges over the disc
/// Step beyond an edge, as a share of its distance. The surface that blocks the ray there owns the
/// edge.
constexpr double kBeyond = 1e-4;

}  // namespace

Camera alone_on_axis(const Camera& camera, int type) {
  CameraSpec spec = camera.spec();
  spec.array.types = {spec.array.types[static_cast<std::size_t>(type)]};
  spec.array.offset = {0, 0};
  spec.array.tilt = {};
  spec.array.focal_jitter = 0;
  spec.lens.decentre = spec.lens.tilt = {};
  spec.focus.mode = FocusMode::distance;
  spec.focus.lens_distance = camera.lens_distance();
  spec.array.sensor_distance = camera.array_back() - camera.sensor();
  spec.array.measured_from = ArrayReference::vertex;
  return Camera(spec);
}

ApertureDiscs fit_aperture(const Camera& camera, double s_max) {
  ApertureDiscs discs;
  const double own = 0.5 * camera.spec().array.diameter;
  if (camera.ideal_array()) {
    discs.radius = discs.near_radius = discs.bound = own * (1 + kDiscRounding);
    return discs;
  }
  const int far_face = camera.surface_count() - 2;
  /// The surface at which a ray ends; -1: it does not end.
  const auto last_surface = [&](double s, Vec2 u) {
    const TraceStatus status = camera.trace({s, 0}, LensIndex{}, u).status;
    return status.status == RayStatus::reached ? -1 : status.surface;
  };
  struct Edge {
    double s;
    Vec2 u;
  };
  std::vector<Edge> near, far, open;  // of the near face, of the far one, of both together
  double ss = 0, us = 0, on_axis = 0;
  for (int step = 0; step <= kDiscSteps; ++step) {
    const double s = s_max * step / kDiscSteps;
    const Passes passes_near = [&](Vec2 u) { return last_surface(s, u) <= far_face; };
    const Passes passes_both = [&](Vec2 u) { return last_surface(s, u) < far_face; };
    Vec2 inside{0, 0};
    if ((step == 0 || step == kDiscSteps) && find_inside(passes_near, own, inside)) {
      const std::vector<Vec2> edge = find_edge(passes_near, inside, 2.2 * own);
      for (const Vec2 u : edge) near.push_back({s, u});
      if (step == kDiscSteps) discs.near_shift = middle(edge).x / s;
    }
    if (!find_inside(passes_both, own, inside)) continue;
    // Seen from the side, the edge away from s belongs to the far face, and the edge towards s to
    // the near face. Light that only just passes the stop crosses the far face's edge.
    double turned_away = kInfinity;
    for (const Vec2 u : find_edge(passes_both, inside, 2.2 * own)) {
      discs.bound = std::max(discs.bound, length(u));
      turned_away = std::min(turned_away, u.x);
      open.push_back({s, u});
      if (passes_near(u + kBeyond * (u - inside))) far.push_back({s, u});
    }
    if (s == 0) on_axis = turned_away;
    ss += s * s;
    us += s * (turned_away - on_axis);
  }
  for (const Edge& edge : near)
    discs.near_radius =
        std::max(discs.near_radius, length(edge.u - Vec2{discs.near_shift * edge.s, 0}));
  // Least squares over the edges, by the Gauss-Newton method.
  discs.shift = ss > 0 ? us / ss : 0;
  discs.radius = own;
  for (int step = 0; step < kFitSteps && !far.empty(); ++step) {
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    Eigen::Vector4d right = Eigen::Vector4d::Zero();
    for (const auto& [s, u] : far) {
      const double part = s / s_max;
      const Vec2 from = u - discs.far_centre({s, 0});
      const double distance = length(from), cosine = from.x / distance;
      const Eigen::Vector4d row{1, part * part, cosine * part, cosine * part * part * part};
      normal += row * row.transpose();
      right += (distance - discs.radius_at({s, 0})) * row;
    }
    const Eigen::Vector4d change = normal.completeOrthogonalDecomposition().solve(right);
    discs.radius += change[0];
    discs.growth += change[1] / (s_max * s_max);
    discs.shift += change[2] / s_max;
    discs.bend += change[3] / (s_max * s_max * s_max);
  }
  if (far.empty()) {
    discs.radius = discs.near_radius;
    discs.shift = discs.near_shift;
  }
  // This includes edges of the near face, for which the fit is a guess.
  double lacking = 0;
  for (const auto& [s, u] : open)
    lacking = std::max(lacking, length(u - discs.far_centre({s, 0})) - discs.radius_at({s, 0}));
  discs.radius += kTracedRoom * lacking;
  discs.near_radius *= 1 + kDiscRounding;
  discs.radius *= 1 + kDiscSafety;
  discs.bound *= 1 + 2 * kDiscSafety;
  return discs;
}

void widen_discs(const Camera& camera, double s_max, ApertureDiscs& discs) {
  const ArraySpec& array = camera.spec().array;
  const double tilt = std::tan(length(array.tilt));
  const double gap = camera.aim_plane(0) - camera.sensor();
  const double slope = std::fabs(discs.shift) + 3 * std::fabs(discs.bend) * s_max * s_max;
  // At least a tenth of the gap remains: an array that would cross the sensor is rejected
  // (validate.h).
  const double fall = std::min(tilt * (field_radius(camera) + field_shift(camera)), 0.9 * gap);
  const double room =
      1.2 * (slope * (tilt * gap + array.focal_jitter * s_max) + tilt * array.thickness +
             (slope + std::fabs(discs.near_shift)) * s_max * fall / (gap - fall)) +
      tilt * tilt * discs.bound;
  discs.radius += room;
  discs.near_radius += room;
  discs.bound += room;
  discs.room = room;
}

}  // namespace plenoflame
