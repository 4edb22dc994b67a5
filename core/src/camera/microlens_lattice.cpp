#include "plenoflame/camera/microlens_lattice.h"

#include <algorithm>
#include <cmath>

namespace plenoflame {

MicrolensLattice::MicrolensLattice(const ArraySpec& array)
    : offset_(array.offset), type_count_(std::max<int>(1, static_cast<int>(array.types.size()))) {
  const bool hexagonal = array.lattice == Lattice::hexagonal;
  const Vec2 q{array.pitch, 0};
  const Vec2 r =
      hexagonal ? Vec2{0.5 * array.pitch, std::sqrt(0.75) * array.pitch} : Vec2{0, array.pitch};
  const double c = std::cos(array.rotation), s = std::sin(array.rotation);
  const auto turned = [&](Vec2 v) { return Vec2{c * v.x - s * v.y, s * v.x + c * v.y}; };
  step_q_ = turned(q);
  step_r_ = turned(r);
}

Vec2 MicrolensLattice::centre(LensIndex lens) const {
  return offset_ + static_cast<double>(lens.q) * step_q_ + static_cast<double>(lens.r) * step_r_;
}

int MicrolensLattice::type(LensIndex lens) const {
  const int remainder = (lens.q - lens.r) % type_count_;
  return remainder < 0 ? remainder + type_count_ : remainder;
}

Vec2 MicrolensLattice::axial(Vec2 point) const {
  const Vec2 p = point - offset_;
  const double determinant = step_q_.x * step_r_.y - step_q_.y * step_r_.x;
  return {(p.x * step_r_.y - p.y * step_r_.x) / determinant,
          (step_q_.x * p.y - step_q_.y * p.x) / determinant};
}

LensIndex MicrolensLattice::nearest(Vec2 point) const {
  const Vec2 a = axial(point);
  const int q = static_cast<int>(std::floor(a.x)), r = static_cast<int>(std::floor(a.y));
  LensIndex best;
  double best_distance = kInfinity;
  for (int dr = 0; dr <= 1; ++dr)
    for (int dq = 0; dq <= 1; ++dq) {
      const LensIndex lens{q + dq, r + dr};
      const double distance = length(centre(lens) - point);
      if (distance < best_distance) {
        best_distance = distance;
        best = lens;
      }
    }
  return best;
}

std::vector<LensIndex> MicrolensLattice::within(Vec2 lower, Vec2 upper) const {
  std::vector<LensIndex> lenses;
  const Vec2 corners[] = {axial(lower), axial({upper.x, lower.y}), axial({lower.x, upper.y}),
                          axial(upper)};
  double q0 = kInfinity, q1 = -kInfinity, r0 = kInfinity, r1 = -kInfinity;
  for (const Vec2 c : corners) {
    q0 = std::min(q0, c.x);
    q1 = std::max(q1, c.x);
    r0 = std::min(r0, c.y);
    r1 = std::max(r1, c.y);
  }
  for (int r = static_cast<int>(std::floor(r0)); r <= static_cast<int>(std::ceil(r1)); ++r)
    for (int q = static_cast<int>(std::floor(q0)); q <= static_cast<int>(std::ceil(q1)); ++q) {
      const Vec2 c = centre({q, r});
      if (c.x >= lower.x && c.x <= upper.x && c.y >= lower.y && c.y <= upper.y)
        lenses.push_back({q, r});
    }
  return lenses;
}

}  // namespace plenoflame
