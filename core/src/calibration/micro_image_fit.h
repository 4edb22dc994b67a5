#pragma once
#include "plenoflame/calibration/white_lattice.h"

namespace plenoflame {

/// Neighbours of a lattice point in the guess. The cell holds the places that are nearer to the
/// point than to these.
struct LatticeCell {
  std::vector<Vec2> neighbours;  ///< [pixel] half of all: the others are opposite
  double reach = 0;              ///< [pixel] to the corners of a cell
  double background = 0;         ///< of the picture, where no micro-image is
  LatticeCell(const LatticeGuess& guess, const Image& white);
  bool holds(Vec2 d) const;
};

/// Fits disc and slope to the pixels of a cell by damped Gauss-Newton steps. `start` gives centre,
/// radius and blur to begin with. fit.good says whether the result can be one.
MicroImageFit fit_micro_image(const Image& white, const LatticeCell& cell,
                              const MicroImageFit& start);

}  // namespace plenoflame
