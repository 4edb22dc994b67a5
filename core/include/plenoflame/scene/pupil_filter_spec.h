#pragma once
#include <string>
#include <vector>

#include "plenoflame/math/vector.h"

namespace plenoflame {

/// The part of the stop that a filter covers.
enum class PupilPartShape {
  sector,   ///< between two angles and two radii: halves, sectors, rings
  polygon,  ///< convex, with its corners listed
};

/// A filter over a part of the main lens' stop. Lengths are in radii of the stop. Axes are camera x
/// (right) and y (down) of the main lens' frame, so angles run from right towards below. For an
/// ideal main lens without a stop, the pupil that limits its rays is used instead.
struct PupilFilterSpec {
  std::string name;
  PupilPartShape shape = PupilPartShape::sector;
  double angle = 0;                ///< [rad] at which the sector begins
  double extent = 0;               ///< [rad] from there on, at most a whole turn; 0: a whole turn
  double inner = 0, outer = 1;     ///< radii of the sector, in radii of the stop
  std::vector<Vec2> corners = {};  ///< of the polygon, in radii of the stop
  std::string transmission = {};   ///< "400 nm 0.9, 700 nm 0.8", 0 outside; empty: 1
  friend bool operator==(const PupilFilterSpec&, const PupilFilterSpec&) = default;
};

}  // namespace plenoflame
