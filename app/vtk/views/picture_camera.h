#pragma once
#include <array>
#include <vector>

#include "plenoflame/math/vector.h"

class vtkRenderer;

namespace plenoflame::views {

/// Points the renderer's camera along `direction` (from the eye to what it sees; any length) so
/// that all points just fit in, with a margin, and sets near and far planes so that everything
/// between a hundredth of the distance and `far` is seen.
/// @param aspect width over height  @param up as seen in the picture
/// @param far [m] from the middle of the points: how far what is drawn may reach
void look_at(const std::vector<Vec3>& points, Vec3 direction, Vec3 up, double aspect, double far,
             vtkRenderer& renderer);

/// The corners of a box of any frame.
std::vector<Vec3> corners(const std::array<double, 6>& bounds);

/// The largest of 1, 2, 5 times a power of ten that is not above `length`.
double round_length(double length);

/// Moves what is in the picture into its lower part, of this share of its height.
void keep_below(double share, vtkRenderer& renderer);

}  // namespace plenoflame::views
