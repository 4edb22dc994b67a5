#pragma once
#include "plenoflame/calibration/white_lattice.h"
#include "plenoflame/image/png_file.h"

namespace plenoflame::cli {

/// Nine parts of a white picture, from the corners, the edges and the middle, enlarged three times.
/// Rings mark the micro-images of the model, in a colour for each type. Micro-images that the model
/// ignores have a cross. @param lattice nullptr: the picture alone
PngImage white_picture(const Image& white, const WhiteLattice* lattice);

}  // namespace plenoflame::cli
