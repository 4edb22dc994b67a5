#include "render/compiled/compiled_frame.h"

#include <algorithm>
#include <cmath>

namespace plenoflame {

bool line_meets(const Box& box, Vec3 origin, Vec3 direction) {
  double from = -kInfinity, to = kInfinity;
  const auto clip = [&](double lower, double upper, double o, double d) {
    if (d == 0) {
      if (o < lower || o > upper) to = -kInfinity;
      return;
    }
    const double a = (lower - o) / d, b = (upper - o) / d;
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  };
  clip(box.lower.x, box.upper.x, origin.x, direction.x);
  clip(box.lower.y, box.upper.y, origin.y, direction.y);
  clip(box.lower.z, box.upper.z, origin.z, direction.z);
  return to > from;
}

void place_frame(const CompiledScene& scene, CompiledCamera& camera) {
  const RigidTransform& world = scene.camera.to_world();
  camera.anchor = 0.5 * (camera.region.lower + camera.region.upper);
  camera.across = world.direction({1, 0, 0});
  camera.down = world.direction({0, 1, 0});
  camera.along = world.direction({0, 0, 1});
}

double half_depth(const CompiledCamera& camera) {
  const Vec3 half = 0.5 * (camera.region.upper - camera.region.lower);
  return std::abs(half.x * camera.along.x) + std::abs(half.y * camera.along.y) +
         std::abs(half.z * camera.along.z);
}

}  // namespace plenoflame
