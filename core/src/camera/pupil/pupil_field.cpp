#include "camera/pupil/pupil_field.h"

#include <algorithm>
#include <cmath>

namespace plenoflame {
namespace {

/// One node for this tangent of the field angle, within limits. Measurements show that 25 nodes
/// suffice for the sensors of large cameras, whose field angle has a tangent of 0.2.
constexpr double kNodeAngle = 0.01;
constexpr int kFewestNodes = 5, kMostNodes = 25;

}  // namespace

double field_radius(const Camera& camera) {
  const SensorSpec& sensor = camera.spec().sensor;
  return sensor.corner() + length(sensor.blur_reach());
}

std::size_t field_nodes(const Camera& camera, double field) {
  const double to_pupil = std::isfinite(camera.exit_pupil())
                              ? std::fabs(camera.exit_pupil() - camera.sensor())
                              : camera.lens_first_order().focal_length;
  const double steps = std::ceil(field / (kNodeAngle * to_pupil));
  return static_cast<std::size_t>(1 + std::clamp(steps, kFewestNodes - 1.0, kMostNodes - 1.0));
}

double field_shift(const Camera& camera) {
  if (!camera.lens_moved()) return 0;
  const Vec3 middle = camera.lens_pose().inverse().point({0, 0, camera.array_front()});
  return std::max(length(camera.foot()), length(Vec2{middle.x, middle.y}));
}

void extend_into_shadow(std::vector<PupilNode>& nodes, std::vector<PupilCuts>& cuts) {
  for (std::size_t i = 1; i < nodes.size(); ++i)
    if (nodes[i].dark() && !nodes[i - 1].dark()) {
      nodes[i] = nodes[i - 1];
      cuts[i] = cuts[i - 1];
      break;
    }
}

}  // namespace plenoflame
