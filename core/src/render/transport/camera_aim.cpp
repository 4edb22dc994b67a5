#include "render/transport/camera_aim.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "plenoflame/base/constants.h"
#include "render/transport/world_paths.h"
#include "sampling/directions.h"

namespace plenoflame {
namespace {

/// Shares of directions that are drawn towards spheres, each twice as large as the one before. The
/// last share is for all directions. The estimate is unbiased for any shares.
constexpr std::array<double, 5> kShares{0.6, 0.15, 0.1, 0.05, 0.1};
/// Number of rays that measure the displacement of the aperture's rays by windows. The smallest
/// sphere is a little larger than the one that holds a share kHeld of them.
constexpr int kTrials = 4096;
constexpr double kHeld = 0.9, kMargin = 1.05;

/// Numbers in (0, 1) that fill a cube evenly, by additive recurrence.
double recurrence(int i, int dimension) {
  // Powers of the root of x^6 = x + 1, for five dimensions.
  constexpr double kRoot = 1.1347241384015194;
  const double step = std::pow(kRoot, -(dimension + 1));
  const double value = 0.5 + step * (i + 1);
  return std::clamp(value - std::floor(value), 1e-9, 1 - 1e-9);
}

}  // namespace

CameraAim::CameraAim(const CompiledScene& scene, Vec3 centre, double radius)
    : scene_(scene),
      cone_(scene.camera),
      to_camera_(scene.camera.to_world().inverse()),
      spread_(cone_.radius()) {
  if (!scene.windows || !(spread_ > 0)) return;
  WindowPath path;
  std::vector<double> distances;
  const double aperture = spread_;
  for (int i = 0; i < kTrials; ++i) {
    // From the aperture's disc, in the plane of the camera's front, towards the scene.
    const double r = aperture * std::sqrt(recurrence(i, 0));
    const double turn = 2 * constants::pi * recurrence(i, 1);
    const Vec3 start =
        scene.camera.to_world().point({cone_.centre().x + r * std::cos(turn),
                                       cone_.centre().y + r * std::sin(turn), cone_.front()});
    const Vec3 aim = centre + radius * recurrence(i, 2) *
                                  cone_direction({0, 0, 1}, 2 * recurrence(i, 3), recurrence(i, 4));
    trace_from(scene, {start, normalize(aim - start)}, path);
    for (const AirSegment& segment : path.segments) {
      const Vec3 to_centre = centre - segment.ray.origin;
      const double ahead = std::clamp(dot(to_centre, segment.ray.direction), 0.0, segment.far);
      if (length(to_centre - ahead * segment.ray.direction) > radius) continue;
      const Vec3 from = to_camera_.point(segment.ray.origin) - cone_.centre();
      distances.push_back(length(cross(from, to_camera_.direction(segment.ray.direction))));
    }
  }
  if (distances.empty()) return;
  const auto held = distances.begin() +
                    static_cast<std::ptrdiff_t>(kHeld * static_cast<double>(distances.size() - 1));
  std::nth_element(distances.begin(), held, distances.end());
  spread_ = std::max(aperture, kMargin * *held);
}

ApertureCone::Direction CameraAim::draw(Vec3 point, double u, double v) const {
  if (!scene_.windows) return cone_.draw(point, u, v);
  const Vec3 to_centre = cone_.centre() - point;
  const double distance = length(to_centre);
  // Rays are not aimed at a telecentric pupil, nor at a pupil around or behind the point.
  const bool aims = spread_ > 0 && to_centre.z < 0;
  Vec3 axis{0, 0, -1};
  if (aims) axis = (1 / distance) * to_centre;
  std::array<double, kShares.size()> versines;
  for (std::size_t k = 0; k < versines.size(); ++k) {
    const double radius = spread_ * static_cast<double>(1 << k);
    versines[k] = 2;
    if (!aims || k + 1 == versines.size() || !(radius < distance)) continue;
    const double sine = radius / distance;
    versines[k] = sine * sine / (1 + std::sqrt((1 - sine) * (1 + sine)));
  }
  std::size_t chosen = 0;
  while (chosen + 1 < kShares.size() && u > kShares[chosen]) u -= kShares[chosen++];
  const double along = std::clamp(u / kShares[chosen], 0.0, 1.0);
  ApertureCone::Direction result;
  result.direction = cone_direction(axis, along * versines[chosen], v);
  // One minus the cosine of the angle with the axis, without cancellation.
  const Vec3 apart = result.direction - axis;
  const double versine = 0.5 * dot(apart, apart);
  double density = 0;
  for (std::size_t k = 0; k < versines.size(); ++k)
    if (k == chosen || versine < versines[k])
      density += kShares[k] / (2 * constants::pi * versines[k]);
  result.solid_angle = 1 / density;
  return result;
}

bool CameraAim::follow(const Ray& world, WindowPath& path, Ray& arriving) const {
  trace_from(scene_, world, path);
  for (std::size_t k = 0; k < path.segments.size(); ++k) {
    AirSegment& segment = path.segments[k];
    arriving = {to_camera_.point(segment.ray.origin), to_camera_.direction(segment.ray.direction)};
    if (!(arriving.direction.z < 0) || !cone_.in_front(arriving.origin)) continue;
    const double end = cone_.distance_to_front(arriving.origin, arriving.direction);
    if (end > segment.far) continue;
    segment.far = end;
    segment.window = -1;
    path.segments.resize(k + 1);
    path.stopped = false;
    return true;
  }
  return false;
}

}  // namespace plenoflame
