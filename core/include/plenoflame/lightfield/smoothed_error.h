#pragma once
#include <utility>
#include <vector>

#include "plenoflame/image/image.h"

namespace plenoflame {

/// Errors by brightness: in groups of values that are alike in brightness, 32 of them or fewer of
/// 64 values at least, the RMS of the brightness, ascending, and of the errors. A mean square of 64
/// squares of normal numbers is known to sqrt(2 / 64) = 18 %, its root to 9 %. The RMS of the
/// brightness is where errors in proportion to it have the RMS that was found: at their mean those
/// of the brightest group, whose values differ most, would be too large.
/// @param values brightness and error of each, at least one
std::vector<std::pair<double, double>> errors_by_brightness(
    std::vector<std::pair<double, double>> values);

/// Standard errors of a picture that few randomisations tell: of two, the scatter of a pixel is
/// known to its own size, and weights by its inverse square are those of chance. Pixels that are
/// alike in brightness err alike: each gets the RMS of its group's, linear between groups of 64
/// pixels or more. The brightness is the mean of a pixel and its eight neighbours, as chance alone
/// may have left the pixel itself dark.
/// @param error of each pixel, in the unit of the flux
Image smoothed_error(const Image& flux, const Image& error);

}  // namespace plenoflame
