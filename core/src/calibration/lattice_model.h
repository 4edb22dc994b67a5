#pragma once
#include "plenoflame/calibration/white_lattice.h"

namespace plenoflame {

/// Fits the model to the measured centres of good micro-images. Outliers, by more than five times
/// the median, lose their `good`. Distortion is fitted only if `distorted`.
/// @param model in: start; out: the fit
void fit_lattice_model(std::vector<MicroImageFit>& images, bool distorted, LatticeModel& model);

/// A model without perspective and distortion from the guess.
LatticeModel plain_model(const LatticeGuess& guess, int width, int height);

}  // namespace plenoflame
