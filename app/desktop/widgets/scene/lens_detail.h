#pragma once
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <array>

#include "model/schematic.h"
#include "plenoflame/camera/camera.h"

class vtkRenderer;

// The microlenses of an array that are drawn one by one.
namespace plenoflame::desktop {

/// A rectangle in the plane of an array, camera x, y [m].
struct ArrayPart {
  Vec2 lower{1, 1}, upper{0, 0};
  bool empty() const { return lower.x > upper.x; }
  double area() const { return (upper.x - lower.x) * (upper.y - lower.y); }
  bool has(Vec2 p) const {
    return lower.x <= p.x && p.x <= upper.x && lower.y <= p.y && p.y <= upper.y;
  }
  /// True if it holds the part in view, and is not much larger than a new one would be.
  bool suits(const ArrayPart& in_view, const Camera& camera) const;
  friend bool operator==(const ArrayPart&, const ArrayPart&) = default;
};

/// From the place of an array in the world to where it is drawn [m].
Vec3 array_shift(const Camera& camera, const Schematic& drawing);
/// The rectangle around the whole array.
ArrayPart whole_array(const Camera& camera);
/// The part of an array that is in view. Empty: its microlenses are too many there, or too small,
/// to be drawn one by one.
ArrayPart large_lenses(const Camera& camera, const Schematic& drawing, vtkRenderer& renderer);
/// The part and some of the array around it, so that small moves need no other microlenses.
ArrayPart with_margin(const ArrayPart& part, const Camera& camera);
/// The microlenses before the pixels around one [columns, rows].
ArrayPart lenses_near(const Camera& camera, const std::array<double, 2>& pixel);
/// Both surfaces of each, in the world; the fewer they are, the finer.
vtkSmartPointer<vtkPolyData> lenses_of(const Camera& camera, const ArrayPart& part);

}  // namespace plenoflame::desktop
