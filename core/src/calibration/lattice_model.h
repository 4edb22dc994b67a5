#pragma once
#include "plenoflame/calibration/white_lattice.h"

namespace plenoflame {

/// Fits the model to the good micro-images' measured centres, and takes those out of `good` that
/// are off by more than five times the middle of all. Distortion only where `distorted`.
/// @param model in: start; out: the fit
void fit_lattice_model(std::vector<MicroImageFit>& images, bool distorted, LatticeModel& model);

/// A model without perspective and distortion from the guess.
LatticeModel plain_model(const LatticeGuess& guess, int width, int height);

}  // namespace plenoflame
