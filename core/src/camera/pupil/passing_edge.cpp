#include "camera/pupil/passing_edge.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "plenoflame/base/constants.h"

namespace plenoflame {
namespace {

constexpr int kDirections = 32;  ///< number of directions of the search

}  // namespace

bool find_inside(const Passes& passes, double range, Vec2& guess) {
  if (passes(guess)) return true;
  for (const int n : {9, 41}) {
    Vec2 sum;
    int count = 0;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        const Vec2 p{guess.x + range * (2.0 * i / (n - 1) - 1),
                     guess.y + range * (2.0 * j / (n - 1) - 1)};
        if (!passes(p)) continue;
        sum = sum + p;
        ++count;
      }
    if (count == 0) continue;
    const Vec2 mean = (1.0 / count) * sum;  // inside, as the passing region is nearly convex
    if (passes(mean)) {
      guess = mean;
      return true;
    }
  }
  return false;
}

std::vector<Vec2> find_edge(const Passes& passes, Vec2 inside, double range, int bisections) {
  std::vector<Vec2> edge;
  for (int k = 0; k < kDirections; ++k) {
    const double angle = 2 * constants::pi * k / kDirections;
    const Vec2 direction{std::cos(angle), std::sin(angle)};
    double lo = 0, hi = range;
    if (passes(inside + hi * direction)) {
      lo = hi;
    } else {
      for (int i = 0; i < bisections; ++i) {
        const double mid = 0.5 * (lo + hi);
        (passes(inside + mid * direction) ? lo : hi) = mid;
      }
    }
    edge.push_back(inside + lo * direction);
  }
  return edge;
}

Vec2 middle(const std::vector<Vec2>& points) {
  Vec2 lower{kInfinity, kInfinity}, upper{-kInfinity, -kInfinity};
  for (const Vec2 p : points) {
    lower = {std::min(lower.x, p.x), std::min(lower.y, p.y)};
    upper = {std::max(upper.x, p.x), std::max(upper.y, p.y)};
  }
  return 0.5 * (lower + upper);
}

}  // namespace plenoflame
