#include "plenoflame/math/vector.h"

namespace plenoflame {

Mat3 rotation_xyz(Vec3 angles) {
  const double cx = std::cos(angles.x), sx = std::sin(angles.x);
  const double cy = std::cos(angles.y), sy = std::sin(angles.y);
  const double cz = std::cos(angles.z), sz = std::sin(angles.z);
  const Mat3 x{{{{1, 0, 0}, {0, cx, -sx}, {0, sx, cx}}}};
  const Mat3 y{{{{cy, 0, sy}, {0, 1, 0}, {-sy, 0, cy}}}};
  const Mat3 z{{{{cz, -sz, 0}, {sz, cz, 0}, {0, 0, 1}}}};
  return z * (y * x);
}

}  // namespace plenoflame
