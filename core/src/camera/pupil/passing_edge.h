#pragma once
#include <functional>
#include <vector>

#include "plenoflame/math/vector.h"

namespace plenoflame {

/// Tells whether a ray to or from a point passes.
using Passes = std::function<bool(Vec2)>;

/// Finds a point that passes near `guess`, on ever finer grids within `range`.
bool find_inside(const Passes& passes, double range, Vec2& guess);

/// The outermost passing points around `inside`, up to `range` away, in equally spaced directions.
/// @param bisections halvings of the range: 24 place the edge to 6e-8 of it
std::vector<Vec2> find_edge(const Passes& passes, Vec2 inside, double range, int bisections = 24);

/// Centre of the points' extent. For an outline cut by two circles the mean would be biased.
Vec2 middle(const std::vector<Vec2>& points);

}  // namespace plenoflame
