#pragma once
#include "plenoflame/calibration/white_lattice.h"
#include "plenoflame/image/png_file.h"

namespace plenoflame::cli {

/// Nine parts of a white picture, from the corners, the edges and the middle, three times as large,
/// with rings around the micro-images where the model has them, in a colour for each type; those
/// that take no part in the model have a cross. @param lattice nullptr: the picture alone
PngImage white_picture(const Image& white, const WhiteLattice* lattice);

}  // namespace plenoflame::cli
