#include "plenoflame/camera/microlens_lattice.h"

#include <algorithm>
#include <cmath>

#include "plenoflame/sampling/philox.h"

namespace plenoflame {
namespace {

/// The number of a lens for a counter-based generator. The draws of a lens do not depend on the
/// order of queries.
std::uint64_t number_of(LensIndex lens) {
  return (std::uint64_t{static_cast<std::uint32_t>(lens.q)} << 32) |
         static_cast<std::uint32_t>(lens.r);
}

int floor_half(int number) {
  return (number - (number & 1)) / 2;
}

}  // namespace

double shortest_pitch(const ArraySpec& array) {
  return is_regular(array) ? array.pitch : std::min(array.pitch, array.pitch_y);
}

double longest_pitch(const ArraySpec& array) {
  return is_regular(array) ? array.pitch : std::max(array.pitch, array.pitch_y);
}

bool is_regular(const ArraySpec& array) {
  return array.lattice == Lattice::hexagonal || !(array.pitch_y > 0) ||
         array.pitch_y == array.pitch;
}

MicrolensLattice::MicrolensLattice(const ArraySpec& array)
    : offset_(array.offset),
      jitter_(array.centre_jitter),
      focal_jitter_(array.focal_jitter),
      jitter_seed_(array.jitter_seed),
      type_count_(std::max<int>(1, static_cast<int>(array.types.size()))),
      columns_(array.columns),
      rows_(array.rows),
      hexagonal_(array.lattice == Lattice::hexagonal) {
  const Vec2 q{array.pitch, 0};
  const Vec2 r = hexagonal_ ? Vec2{0.5 * array.pitch, std::sqrt(0.75) * array.pitch}
                            : Vec2{0, array.pitch_y > 0 ? array.pitch_y : array.pitch};
  const double c = std::cos(array.rotation), s = std::sin(array.rotation);
  const auto turned = [&](Vec2 v) { return Vec2{c * v.x - s * v.y, s * v.x + c * v.y}; };
  step_q_ = turned(q);
  step_r_ = turned(r);
}

Vec2 MicrolensLattice::centre(LensIndex lens) const {
  const Vec2 place =
      offset_ + static_cast<double>(lens.q) * step_q_ + static_cast<double>(lens.r) * step_r_;
  // The offset gives the exact position of lens (0, 0).
  return jitter_ > 0 && !(lens == LensIndex{}) ? place + displacement(lens) : place;
}

double MicrolensLattice::focal_factor(LensIndex lens) const {
  if (focal_jitter_ == 0 || lens == LensIndex{}) return 1;
  return 1 + focal_jitter_ * (2 * unit_uniform(philox(jitter_seed_, number_of(lens), 1)[0]) - 1);
}

Vec2 MicrolensLattice::displacement(LensIndex lens) const {
  const auto random = philox(jitter_seed_, number_of(lens), 0);
  const double radius = jitter_ * std::sqrt(unit_uniform(random[0]));
  const double angle = 6.283185307179586 * unit_uniform(random[1]);
  return {radius * std::cos(angle), radius * std::sin(angle)};
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

/// Rows of a hexagonal lattice begin at the camera's y axis or half a pitch to its right.
int MicrolensLattice::column(LensIndex lens) const {
  return hexagonal_ ? lens.q + floor_half(lens.r) : lens.q;
}

bool MicrolensLattice::has(LensIndex lens) const {
  const auto within_count = [](int number, int count) {
    return count == 0 || (number >= -(count - 1) / 2 && number <= count / 2);
  };
  return within_count(lens.r, rows_) && within_count(column(lens), columns_);
}

LensIndex MicrolensLattice::nearest(Vec2 point) const {
  const LensIndex place = nearest_place(point);
  if (has(place)) return place;
  // The point is beyond an edge. Candidates are in the rows next to the point, or in the last rows.
  // In each row the candidate is the lens opposite the point, or the end of the row.
  LensIndex best;
  double best_distance = kInfinity;
  const auto clamped = [](int number, int count) {
    return count == 0 ? number : std::clamp(number, -(count - 1) / 2, count / 2);
  };
  constexpr int kAround = 2;
  const double across = axial(point).x + (hexagonal_ ? 0.5 * axial(point).y : 0.0);
  for (int dr = -kAround; dr <= kAround; ++dr)
    for (int dc = -kAround; dc <= kAround; ++dc) {
      const int r = clamped(clamped(place.r, rows_) + dr, rows_);
      // `across` counts from the axis; the first column of every second row is at one half.
      const double start = hexagonal_ ? 0.5 * (r & 1) : 0.0;
      const int c = clamped(static_cast<int>(std::floor(across - start + 0.5)) + dc, columns_);
      const LensIndex lens{c - (hexagonal_ ? floor_half(r) : 0), r};
      const double distance = length(centre(lens) - point);
      if (distance < best_distance) {
        best_distance = distance;
        best = lens;
      }
    }
  return best;
}

LensIndex MicrolensLattice::nearest_place(Vec2 point) const {
  const Vec2 a = axial(point);
  const int q = static_cast<int>(std::floor(a.x)), r = static_cast<int>(std::floor(a.y));
  LensIndex best;
  double best_distance = kInfinity;
  // A displaced lens may be nearest although its node is not among the four around the point.
  const int margin = jitter_ > 0 ? 1 : 0;
  for (int dr = -margin; dr <= 1 + margin; ++dr)
    for (int dq = -margin; dq <= 1 + margin; ++dq) {
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
  if (!(lower.x <= upper.x && lower.y <= upper.y)) return lenses;
  const Vec2 low = lower - Vec2{jitter_, jitter_}, high = upper + Vec2{jitter_, jitter_};
  const Vec2 corners[] = {axial(low), axial({high.x, low.y}), axial({low.x, high.y}), axial(high)};
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
      if (c.x >= lower.x && c.x <= upper.x && c.y >= lower.y && c.y <= upper.y && has({q, r}))
        lenses.push_back({q, r});
    }
  return lenses;
}

}  // namespace plenoflame
