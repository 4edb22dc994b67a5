#include "plenoflame/math/ray_span.h"

#include <algorithm>
#include <cmath>

namespace plenoflame {

RaySpan clip_to_box(const Box& box, const Ray& ray, double near, double far) {
  if (box.empty()) return {};
  const auto slab = [&](double lower, double upper, double origin, double direction) {
    const double margin = 4e-16 * (std::fabs(lower) + std::fabs(upper) + std::fabs(origin));
    if (direction == 0) {
      if (origin < lower - margin || origin > upper + margin) far = near;
      return;
    }
    const double a = (lower - margin - origin) / direction;
    const double b = (upper + margin - origin) / direction;
    near = std::max(near, std::min(a, b));
    far = std::min(far, std::max(a, b));
  };
  slab(box.lower.x, box.upper.x, ray.origin.x, ray.direction.x);
  slab(box.lower.y, box.upper.y, ray.origin.y, ray.direction.y);
  slab(box.lower.z, box.upper.z, ray.origin.z, ray.direction.z);
  const bool finite = std::isfinite(near) && std::isfinite(far) &&
                      std::isfinite(dot(ray.origin, ray.origin)) &&
                      std::isfinite(dot(ray.direction, ray.direction));
  if (!finite || !(near < far)) return {};
  return {near, far};
}

}  // namespace plenoflame
