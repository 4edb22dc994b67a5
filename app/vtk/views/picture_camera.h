#pragma once
#include <array>
#include <vector>

#include "plenoflame/math/vector.h"

class vtkRenderer;

namespace plenoflame::views {

/// Points the renderer's camera along `direction` (from the eye to what it sees; any length) so
/// that all points just fit in, with a margin. Near and far planes enclose everything between a
/// hundredth of the distance and `far`.
/// @param aspect width over height
/// @param up as seen in the picture
/// @param far [m] from the middle of the points: largest distance that is drawn
void look_at(const std::vector<Vec3>& points, Vec3 direction, Vec3 up, double aspect, double far,
             vtkRenderer& renderer);

/// Parts of a scene that pictures show.
enum class Subject { scene, flame, camera, array };

/// Things beside flame and camera that decide about the side from which a scene is seen.
struct Surroundings {
  bool surfaces = false;         ///< solid ones, walls and floors included
  bool bodies = false;           ///< solid surfaces that are no planes
  bool several_cameras = false;  ///< they look at the same scene
};

/// The way from the middle of the subject towards the eye (any length). The eye is to the left of
/// the camera, so that light runs from left to right.
/// @param axis,right,up of the camera: unit vectors of the world
Vec3 way_to_eye(Subject subject, Vec3 axis, Vec3 right, Vec3 up, const Surroundings& around);

/// The corners of a box of any frame.
std::vector<Vec3> corners(const std::array<double, 6>& bounds);

/// The largest of 1, 2, 5 times a power of ten that is not above `length`.
double round_length(double length);

/// Moves what is in the picture into its lower part, of this share of its height.
void keep_below(double share, vtkRenderer& renderer);

}  // namespace plenoflame::views
