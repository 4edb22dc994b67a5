#pragma once
#include <vector>

#include "plenoflame/image/image.h"
#include "plenoflame/math/vector.h"

namespace plenoflame {

/// A corner between four squares, or a dot, within a micro-image.
struct BoardMark {
  Vec2 pixel;        ///< [pixel]
  Vec2 diagonal;     ///< corners: (cos 2 a, sin 2 a) of the angle a of the bright squares' diagonal
  double error = 0;  ///< [pixel] standard deviation of the place
};

/// Finds the marks of a picture that lie in a disc, each by a fit of its own to the pixels about
/// it.
class MarkFinder {
 public:
  /// @param light NaN where a pixel says nothing
  MarkFinder(const Image& light, bool dots);
  /// @param centre, radius of a micro-image [pixel]
  std::vector<BoardMark> marks_in(Vec2 centre, double radius) const;

 private:
  struct Patch {
    std::vector<Vec2> places;   ///< [pixel] from the mark
    std::vector<double> light;  ///< over its mean
  };
  Patch patch(Vec2 about, double reach, Vec2 centre, double radius) const;
  bool fit_corner(Vec2 centre, double radius, BoardMark& mark) const;
  bool fit_dot(Vec2 centre, double radius, double size, BoardMark& mark) const;

  const Image& light_;
  bool dots_;
  Image smooth_;
  Image strength_;  ///< how much each pixel looks like a mark
};

}  // namespace plenoflame
