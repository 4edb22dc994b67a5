#pragma once
#include "plenoflame/image/image.h"
#include "plenoflame/math/vector.h"

namespace plenoflame {

/// A lattice of micro-images in the middle of a white picture. Lengths are pixels of the upright
/// picture: x to the right, y down, pixel (0, 0) has its centre at (0.5, 0.5). Its steps are 60
/// degrees apart (hexagonal) or 90 (square); step_i is the one nearest to +x.
struct LatticeGuess {
  bool hexagonal = false;
  Vec2 origin;          ///< [pixel] of a micro-image near the middle
  Vec2 step_i, step_j;  ///< [pixel] to the right, and down (hexagonal: down and half to the right)
  /// Share of the picture's variance that repeats with the lattice, 0 to 1.
  double contrast = 0;
  double radius = 0;  ///< [pixel] of a micro-image, roughly

  Vec2 point(double i, double j) const { return origin + i * step_i + j * step_j; }
  /// [pixel] of a step; of a square lattice the mean of both
  double pitch() const { return 0.5 * (length(step_i) + length(step_j)); }
};

/// Finds the lattice by the autocorrelation of the picture's middle (1024 pixels a side at most):
/// noise, vignetting and dust do not repeat. Pitches from 4 pixels to a fifth of that side.
/// @throws InputError if there is no lattice, with a description of what was seen
LatticeGuess find_lattice(const Image& white);

}  // namespace plenoflame
