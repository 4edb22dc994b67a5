#pragma once
#include "plenoflame/math/vector.h"

namespace plenoflame {

/// Part of a ray, between two values of its parameter.
struct RaySpan {
  double near = 0, far = 0;
  bool empty() const { return !(near < far); }
};

/// [near, far] restricted to the box, which is widened by a few ulp so that nothing is cut off.
/// Either end may be infinite. Empty for rays that are not finite.
RaySpan clip_to_box(const Box& box, const Ray& ray, double near, double far);

}  // namespace plenoflame
