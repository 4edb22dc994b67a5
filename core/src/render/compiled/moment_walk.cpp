#include "render/compiled/moment_walk.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "plenoflame/sampling/philox.h"
#include "plenoflame/sampling/sobol.h"

namespace plenoflame {
namespace {

/// Functions are of order 1. Below this value a point is a linear combination of the kept points.
constexpr double kDependent = 1e-7;

}  // namespace

double WalkRandom::uniform() {
  state_ += 0x9e3779b97f4a7c15u;
  return unit_uniform(static_cast<std::uint32_t>(mix64(state_) >> 32));
}

MomentWalk::MomentWalk(std::size_t functions)
    : n_(functions),
      free_(functions),
      inverse_(functions * functions),
      weights_(functions),
      change_(functions),
      points_(functions) {}

void MomentWalk::start() {
  free_ = n_;
  std::fill(inverse_.begin(), inverse_.end(), 0.0);
  for (std::size_t i = 0; i < n_; ++i) inverse_[i * n_ + i] = 1;
  std::fill(weights_.begin(), weights_.end(), 0.0);
  std::fill(points_.begin(), points_.end(), kFree);
}

/// Replaces the values of the point at `place` by those of the new point.
inline void MomentWalk::exchange(std::size_t place, const double* change, std::size_t n) {
  const double pivot = 1 / change[place];
  for (std::size_t k = 0; k < n; ++k) {
    double* const column = inverse_.data() + k * n;
    const double row = column[place] * pivot;
    for (std::size_t i = 0; i < n; ++i) column[i] -= change[i] * row;
    column[place] = row;
  }
}

/// Compiling a camera spends most of its time here, with 8 functions. Only one branch depends on
/// the results.
template <std::size_t n>
void MomentWalk::add_to_full(std::size_t point, const double* values, double weight,
                             WalkRandom& random) {
  double c[n] = {};
  for (std::size_t k = 0; k < n; ++k) {
    const double* const column = inverse_.data() + k * n;
    for (std::size_t i = 0; i < n; ++i) c[i] += column[i] * values[k];
  }
  constexpr double kNever = std::numeric_limits<double>::infinity();
  double up[n], down[n];  // length of the walk until this weight vanishes
  for (std::size_t i = 0; i < n; ++i) {
    const double ratio = weights_[i] / c[i];
    up[i] = c[i] > 0 ? ratio : kNever;
    down[i] = c[i] < 0 ? -ratio : kNever;
  }
  double more = kNever, less = weight;
  for (std::size_t i = 0; i < n; ++i) {
    more = up[i] < more ? up[i] : more;
    less = down[i] < less ? down[i] : less;
  }
  const bool goes_up = random.uniform() * (more + less) < less;
  const double step = goes_up ? more : -less;
  const double* const way = goes_up ? up : down;
  const auto leaves = static_cast<std::size_t>(std::find(way, way + n, std::abs(step)) - way);
  for (std::size_t i = 0; i < n; ++i) weights_[i] = std::max(0.0, weights_[i] - step * c[i]);
  if (leaves == n) return;  // the new point itself leaves
  exchange(leaves, c, n);
  points_[leaves] = point;
  weights_[leaves] = weight + step;
}

void MomentWalk::add(std::size_t point, const double* values, double weight, WalkRandom& random) {
  if (n_ == 8 && free_ == 0) return add_to_full<8>(point, values, weight, random);
  double* const c = change_.data();
  std::fill(change_.begin(), change_.end(), 0.0);
  for (std::size_t k = 0; k < n_; ++k) {
    const double* const column = inverse_.data() + k * n_;
    for (std::size_t i = 0; i < n_; ++i) c[i] += column[i] * values[k];
  }
  // The values are the sum of c[i] times the vectors of the basis. The basis has the kept points'
  // values and unit vectors. The point replaces a unit vector with a nonzero c[i].
  std::size_t best = n_;
  for (std::size_t i = 0; i < n_; ++i)
    if (points_[i] == kFree && std::abs(c[i]) > kDependent &&
        (best == n_ || std::abs(c[i]) > std::abs(c[best])))
      best = i;
  if (best < n_) {
    exchange(best, c, n_);
    --free_;
    points_[best] = point;
    weights_[best] = weight;
    return;
  }
  // The point gains weight and the others lose it, or the reverse.
  double more = std::numeric_limits<double>::infinity(), less = weight;
  std::size_t leaves_more = n_, leaves_less = n_;
  for (std::size_t i = 0; i < n_; ++i) {
    if (points_[i] == kFree) continue;
    if (c[i] > 0 && weights_[i] < more * c[i]) more = weights_[i] / c[i], leaves_more = i;
    if (c[i] < 0 && weights_[i] < less * -c[i]) less = weights_[i] / -c[i], leaves_less = i;
  }
  const bool goes_up = random.uniform() * (more + less) < less;
  const double step = goes_up ? more : -less;
  const std::size_t leaves = goes_up ? leaves_more : leaves_less;
  for (std::size_t i = 0; i < n_; ++i)
    if (points_[i] != kFree) weights_[i] = std::max(0.0, weights_[i] - step * c[i]);
  if (leaves == n_) return;  // the new point itself leaves
  exchange(leaves, c, n_);
  points_[leaves] = point;
  weights_[leaves] = weight + step;
}

std::vector<MomentWalk::Kept> MomentWalk::kept() const {
  std::vector<Kept> kept;
  for (std::size_t i = 0; i < n_; ++i)
    if (points_[i] != kFree && weights_[i] > 0) kept.push_back({points_[i], weights_[i]});
  return kept;
}

}  // namespace plenoflame
