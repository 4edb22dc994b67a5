#pragma once
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "plenoflame/calibration/count_frames.h"
#include "plenoflame/calibration/raw_import.h"
#include "plenoflame/image/image.h"

namespace plenoflame {

/// [counts^2] of rounding to whole numbers
inline constexpr double kRoundingVariance = 1.0 / 12;

/// The factors that a white picture or a flat field gives each pixel.
struct EvenFactors {
  /// Factor on a pixel's light: expected over measured light, with the median 1 in each colour. 0:
  /// the pixel is unknown. Below 0: it saw almost no light where light was expected (dirt, or an
  /// edge that the model places elsewhere).
  std::vector<float> factors;
  std::vector<float> relative_variance;  ///< of the factors
};

/// @param measured   frames of an evenly bright scene
/// @param expected   relative light of each pixel; nullptr: all pixels are expected alike
/// @param colours    number of colours of a mosaic, or 1
/// @param colour_of  the colour of a pixel, below `colours`
/// @param light_of   light of a pixel in `measured` [counts above dark, as of a linear sensor], and
///                   its variance
/// @throws InputError for a picture of another kind of scene: more than 5 % of its pixels are too
///         dark, or it does not vary as expected
EvenFactors even_factors(
    const CountFrames& measured, const Image* expected, std::size_t colours,
    const std::function<std::size_t(std::size_t pixel)>& colour_of,
    const std::function<std::pair<double, double>(std::size_t pixel)>& light_of);

/// Variance of the mean of frames [counts^2] where noise is that of the sensor's electrons.
/// @param above_black counts above the level without any electrons
double sensor_variance(const CountFrames& frames, double above_black, const SensorResponse& sensor);

/// Counts above dark and their variance, as a linear sensor would have given them.
void make_linear(double curvature, double& counts, double& variance);

}  // namespace plenoflame
