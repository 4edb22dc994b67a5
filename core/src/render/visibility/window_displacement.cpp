#include "render/visibility/window_displacement.h"

#include <algorithm>
#include <cmath>

#include "plenoflame/base/constants.h"
#include "plenoflame/math/ray_span.h"
#include "render/visibility/camera_front.h"

namespace plenoflame {
namespace {

constexpr int kRays = 1 << 14;
constexpr double kBetweenMargin = 1.3;  ///< for rays between the traced ones
constexpr double kFrontMargin = 1.1;    ///< of the front aperture: oblique rays leave beside it
/// Rays are aimed at a room around the boxes. No ray in this outermost share of the room may meet
/// the boxes. Otherwise the room is doubled, at most kMostDoublings times.
constexpr double kFreeShare = 0.4;
constexpr int kMostDoublings = 6;

/// Points that are well spread over the unit hypercube: powers of 1/g with g^5 = g + 1 (M. Roberts'
/// sequence).
class Spread {
 public:
  void step() {
    constexpr double kStep[4] = {0.8566748838545029, 0.733891856627126, 0.6287067210378087,
                                 0.5385972572236101};
    for (std::size_t d = 0; d < 4; ++d) {
      point_[d] += kStep[d];
      point_[d] -= std::floor(point_[d]);
    }
  }
  /// A point of the unit disc, evenly distributed.
  Vec2 on_disc(std::size_t first) const {
    const double r = std::sqrt(point_[first]), angle = 2 * constants::pi * point_[first + 1];
    return {r * std::cos(angle), r * std::sin(angle)};
  }

 private:
  double point_[4] = {0.5, 0.5, 0.5, 0.5};
};

/// Boxes as the camera sees them, between two planes across its axis.
struct Seen {
  Box whole{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};  ///< world
  Vec2 middle;
  double near = kInfinity, far = -kInfinity, radius = 0;
};

Seen look_at(const RigidTransform& to_camera, const std::vector<Box>& boxes) {
  Seen seen;
  std::vector<Vec3> points;
  for (const Box& box : boxes)
    for (int i = 0; i < 8; ++i) {
      const Vec3 corner{(i & 1) ? box.upper.x : box.lower.x, (i & 2) ? box.upper.y : box.lower.y,
                        (i & 4) ? box.upper.z : box.lower.z};
      Vec3 &lower = seen.whole.lower, &upper = seen.whole.upper;
      lower = {std::min(lower.x, corner.x), std::min(lower.y, corner.y),
               std::min(lower.z, corner.z)};
      upper = {std::max(upper.x, corner.x), std::max(upper.y, corner.y),
               std::max(upper.z, corner.z)};
      points.push_back(to_camera.point(corner));
    }
  Vec2 lower{kInfinity, kInfinity}, upper{-kInfinity, -kInfinity};
  for (const Vec3 p : points) {
    lower = {std::min(lower.x, p.x), std::min(lower.y, p.y)};
    upper = {std::max(upper.x, p.x), std::max(upper.y, p.y)};
    seen.near = std::min(seen.near, p.z);
    seen.far = std::max(seen.far, p.z);
  }
  seen.middle = 0.5 * (lower + upper);
  seen.radius = 0.5 * length(upper - lower);
  return seen;
}

/// Results for rays from the camera's front to the surrounding of the boxes.
struct Found {
  double displacement = 0;  ///< largest one of rays that meet the boxes
  double widest = 0;        ///< largest aim distance of these rays from the boxes' middle
};

Found try_rays(const CompiledScene& scene, const Seen& seen, double front_radius, double reach) {
  const RigidTransform& to_world = scene.camera.to_world();
  const RigidTransform to_camera = to_world.inverse();
  const CameraFront front(scene.camera);
  const double depth = 0.5 * (seen.near + seen.far);
  Found found;
  Spread spread;
  WindowPath path;
  for (int i = 0; i < kRays; ++i) {
    spread.step();
    const Vec2 at = front_radius * spread.on_disc(0), way = reach * spread.on_disc(2);
    const Vec3 from{at.x, at.y, 0}, to{seen.middle.x + way.x, seen.middle.y + way.y, depth};
    const Vec3 direction = normalize(to - from);
    const Ray world{to_world.point(from), to_world.direction(direction)};
    scene.windows->trace({world.at(front.t_near(world)), world.direction}, path);
    for (const AirSegment& stretch : path.segments) {
      const RaySpan span = clip_to_box(seen.whole, stretch.ray, 0, stretch.far);
      if (span.empty()) continue;
      found.widest = std::max(found.widest, length(way));
      for (const double t : {span.near, span.far}) {
        const Vec3 p = to_camera.point(stretch.ray.at(t));
        const Vec2 straight = at + (p.z / direction.z) * Vec2{direction.x, direction.y};
        found.displacement = std::max(found.displacement, length(Vec2{p.x, p.y} - straight));
      }
    }
  }
  return found;
}

}  // namespace

double displacement_by_windows(const CompiledScene& scene, const std::vector<Box>& boxes) {
  if (boxes.empty()) return kInfinity;
  const Seen seen = look_at(scene.camera.to_world().inverse(), boxes);
  const MainLensSpec& lens = scene.scene.camera.lens;
  const double front_radius =
      kFrontMargin * 0.5 *
          (lens.surfaces.empty() ? lens.diameter : lens.surfaces.front().diameter) +
      length(lens.decentre);
  if (!(seen.near > 0) || !std::isfinite(seen.far + seen.radius)) return kInfinity;
  // Straight lines to the ends of the boxes cross the plane of their middle within this distance.
  const double steep = (front_radius + seen.radius + length(seen.middle)) / seen.near;
  const double within = seen.radius + 0.5 * (seen.far - seen.near) * steep;
  double room = std::max(0.5 * within, 1e-3 * seen.far);
  for (int doubling = 0; doubling <= kMostDoublings; ++doubling, room *= 2) {
    const Found found = try_rays(scene, seen, front_radius, within + room);
    if (found.widest < within + (1 - kFreeShare) * room) return kBetweenMargin * found.displacement;
  }
  return kInfinity;
}

}  // namespace plenoflame
