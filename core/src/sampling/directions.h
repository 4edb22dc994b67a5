#pragma once
#include "plenoflame/math/vector.h"

namespace plenoflame {

/// The direction at an angle with versine 1 - cos from `axis` (unit), at azimuth 2 pi v.
Vec3 cone_direction(Vec3 axis, double versine, double v);

/// A direction around `normal` (unit) in proportion to the cosine with it. From two numbers in (0,
/// 1), the cosine is sqrt(1 - u), the azimuth 2 pi v.
Vec3 cosine_direction(Vec3 normal, double u, double v);

}  // namespace plenoflame
