#pragma once
#include <vector>

#include "calibration/board_views.h"

namespace plenoflame {

constexpr std::size_t kFewestPairs = 20;  ///< of lines that meet, which tell a plane

/// The place where two lines come nearest to each other: distance z, and by how many pixels they
/// miss.
struct Meeting {
  double z = 0, miss = 0;
  Vec2 direction;  ///< x/z, y/z

  Meeting(const SeenMark& a, const SeenMark& b) {
    const Vec2 apart = b.line.position - a.line.position, turned = b.line.slope - a.line.slope;
    z = -dot(apart, turned) / dot(turned, turned);
    const Vec2 p = a.at(z), q = b.at(z);
    miss = length(q - p) / a.pixel_at(z);
    direction = (0.5 / z) * (p + q);
  }
};

/// A plane in front of the camera: 1/z = near + along x/z + across y/z, linear in directions.
struct BoardPlane {
  double near = 0, along = 0, across = 0;

  double distance(const MicroImages::Line& line) const {
    const Vec2 p = line.position, t = line.slope;
    return (1 - along * p.x - across * p.y) / (near + along * t.x + across * t.y);
  }

  /// The distance between two at which most lines meet, then the plane near it.
  /// @param nearest, farthest [m]
  static BoardPlane where_most_meet(const std::vector<Meeting>& meetings, double nearest,
                                    double farthest);
  /// Least squares of those within a window that closes. @param window [1/m]
  void fit(const std::vector<Meeting>& meetings, double window);
};

}  // namespace plenoflame
