#pragma once
#include <utility>
#include <vector>

#include "plenoflame/image/image.h"

namespace plenoflame {

/// Errors by brightness: values are sorted by brightness into at most 32 groups of at least 64
/// values. Each group gives the RMS of brightness, ascending, and of errors. A mean square of 64
/// squares of normal numbers is known to sqrt(2 / 64) = 18 %, its root to 9 %. With the RMS of
/// brightness, errors in proportion to it have the RMS that was found. At the mean brightness the
/// errors of the brightest group, whose values differ most, would be too large.
/// @param values brightness and error of each, at least one
std::vector<std::pair<double, double>> errors_by_brightness(
    std::vector<std::pair<double, double>> values);

/// Smooths standard errors that come from few replicates. With two replicates the scatter of a
/// pixel is as uncertain as it is large, and weights by its inverse square are random. Pixels of
/// equal brightness have equal errors, so each pixel gets the RMS of its group. Values are linear
/// between groups of 64 pixels or more. The brightness is the mean of a pixel and its eight
/// neighbours, because chance may have left the pixel itself dark.
/// @param error of each pixel, in the unit of the flux
Image smoothed_error(const Image& flux, const Image& error);

}  // namespace plenoflame
