#pragma once
#include <array>

#include "plenoflame/math/vector.h"
#include "plenoflame/scene/array_spec.h"

namespace plenoflame {

/// The clear aperture of every microlens of an array, about its centre in the array's axes. It is a
/// circle, or the area between pairs of parallel sides.
class MicrolensAperture {
 public:
  static constexpr int kMostPairs = 3;
  MicrolensAperture() = default;
  explicit MicrolensAperture(const ArraySpec& array);

  /// Pairs of parallel sides: 2 of a square or rectangle, 3 of a hexagon, 0 of a circle.
  int pairs() const { return pairs_; }
  Vec2 normal(int pair) const { return normals_[static_cast<std::size_t>(pair)]; }
  double half_width(int pair) const { return half_widths_[static_cast<std::size_t>(pair)]; }
  /// Radius of the circle around it [m]; of a circle its own.
  double radius() const { return radius_; }
  double area() const { return area_; }  ///< [m^2]
  /// Tells whether a point belongs to it, its edge included.
  bool holds(Vec2 point) const;

 private:
  int pairs_ = 0;
  std::array<Vec2, kMostPairs> normals_{};
  std::array<double, kMostPairs> half_widths_{};
  double radius_ = 0, area_ = 0;
};

/// The same array with circular microlenses that the given ones just fit into (which may overlap).
ArraySpec with_circumscribed_circles(ArraySpec array);

}  // namespace plenoflame
