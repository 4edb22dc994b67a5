#pragma once
#include <array>
#include <vector>

#include "plenoflame/math/vector.h"

namespace plenoflame {
class Camera;
}

namespace plenoflame::desktop {

/// A scene drawn with the long empty stretches of its optical axis shortened, so that flame, main
/// lens and array are seen together. Each of these keeps its size and shape; lines between them
/// bend where a shortened stretch begins and ends.
class Schematic {
 public:
  /// An empty stretch of the axis that is drawn shorter than it is.
  struct Gap {
    double begin = 0, end = 0;              ///< [m] along the axis
    double drawn_begin = 0, drawn_end = 0;  ///< [m] where they are drawn
  };

  /// To scale.
  Schematic() = default;
  /// @param origin of the axis, which stays where it is @param axis unit vector
  /// @param parts stretches of the axis that keep their length [m]; they may overlap
  /// @param longest an empty stretch is drawn at most that long [m]
  Schematic(const Vec3& origin, const Vec3& axis, std::vector<std::array<double, 2>> parts,
            double longest);

  bool is_to_scale() const { return gaps_.empty(); }
  const std::vector<Gap>& gaps() const { return gaps_; }
  /// The place at which a point of the world is drawn.
  Vec3 place(const Vec3& world) const;
  /// The point of the axis at this distance of the drawing [m].
  Vec3 on_axis(double drawn) const { return origin_ + drawn * axis_; }
  /// A straight line of the world as it is drawn; the first point is left out.
  std::vector<Vec3> line(const Vec3& from, const Vec3& to) const;

 private:
  double drawn(double along) const;
  Vec3 origin_, axis_{1, 0, 0};
  std::vector<Gap> gaps_;
};

/// The stretches of its own axis that a camera covers.
struct CameraOnAxis {
  CameraOnAxis() = default;
  explicit CameraOnAxis(const Camera& camera);
  Vec3 position, axis{1, 0, 0};                       ///< front vertex [m] world; unit vector
  double lens_back = 0, array_front = 0, sensor = 0;  ///< [m] along the axis, not positive
  double width = 0;                                   ///< [m] of its widest part
};

/// Something that cameras look at, by the corners of a box around it [m] world.
struct ThingSeen {
  std::vector<Vec3> corners;
  /// A plane: where it runs along an axis it is shortened with what it runs beside.
  bool flat = false;
};

/// Drawings of the axes of cameras that look at the same things, one for each. A single camera
/// stays where it is, and things come nearer. With several cameras the things stay, and the cameras
/// come nearer as far as they have room beside each other. A camera is drawn to scale if things are
/// beside or behind it, or, with several cameras, if it
/// sees nothing.
std::vector<Schematic> shortened_axes(const std::vector<CameraOnAxis>& cameras,
                                      const std::vector<ThingSeen>& things);

}  // namespace plenoflame::desktop
