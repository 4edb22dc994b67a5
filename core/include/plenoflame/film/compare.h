#pragma once
#include <cstddef>
#include <limits>
#include <string>

#include "plenoflame/film/film.h"
#include "plenoflame/image/light_field.h"

namespace plenoflame {

/// The difference of one image from a reference, over the pixels that both hold. A pixel is lit
/// when the weighted mean of both is above kLitShare (film.h) of its largest value. Each image is
/// weighted by the other's mean variance, so that noise does not select pixels in which one image
/// is too bright. Without standard errors the weights are equal. Values marked * use the standard
/// errors s of both images, s^2 = s_a^2 + s_b^2, plus the rounding of the stored single precision.
/// An image without standard errors counts as exact; errors of different pixels count as
/// independent.
struct Comparison {
  PixelWindow window;   ///< common part of both
  std::string caution;  ///< why the difference means little: two units. Empty: nothing is wrong
  std::size_t lit_pixels = 0;
  double mean = 0;            ///< [W] of a, over lit pixels
  double reference_mean = 0;  ///< [W] of the reference, over lit pixels
  double relative_rmse = 0;   ///< sqrt(mean((a - b)^2)) / mean(b) over lit pixels
  double relative_bias = 0;   ///< mean(a - b) / mean(b) over lit pixels
  /// Flux of a in pixels that are not lit, as a share of a's flux: what relative_rmse misses.
  double stray_share = 0;
  double largest_difference = 0;  ///< [W] of a - b by magnitude, over all pixels; with its sign
  int largest_column = 0, largest_row = 0;  ///< where (of the sensor)

  bool has_standard_errors = false;  ///< either has; all below is 0 otherwise
  double relative_bias_error = 0;    ///< * standard error of relative_bias
  /// * The larger relative standard error of the two means over lit pixels. Pixels that no ray with
  /// light has reached do not make it too small. The squared errors of the others are too large by
  /// the same amount.
  double mean_error = 0;
  /// * Value of relative_rmse expected for an unbiased a: sqrt(mean(s^2)) / mean(b).
  double expected_rmse = 0;
  double largest_z = 0;  ///< * (a - b) / s, largest by magnitude; with its sign
  int largest_z_column = 0, largest_z_row = 0;
  /// Degrees of freedom of the standard errors: the smallest number of replicates of an image with
  /// standard errors ("render.replicates" of its numbers), minus one. Infinite if no image has this
  /// number.
  double freedom = std::numeric_limits<double>::infinity();
  /// * Probability that noise alone makes largest_z this large among all pixels (Sidak). It assumes
  /// normal differences and Student's t with `freedom` degrees of freedom.
  double largest_z_probability = 1;
  /// * Reduced chi-square, mean of ((a - b) / s)^2 over pixels with s > 0. Its expected value is 1,
  /// or (R - 1) / (R - 3) when s was estimated from R replicates.
  double chi_square = 0;
  std::size_t chi_square_pixels = 0;
  /// Detects differences that are small in each pixel but alike among neighbours. It is the ratio
  /// of (sum of a - b)^2 and sum of (a - b)^2 in blocks of kBlock x kBlock pixels. Both are summed
  /// over blocks in units of their flux. 1 if differences are independent, with any size and
  /// distribution. Nearer to 1 if they are smaller than the standard errors, as for images with the
  /// same seed.
  double block_chi_square = 0;
  std::size_t blocks = 0;
  /// The excess of that over 1, in standard deviations of a normal distribution (Wilson and
  /// Hilferty, PNAS 17 (1931) 684). Above 5: the images differ by more than noise.
  double block_score = 0;
  /// Share of the pixels lit in one image that are exactly 0 in the other. Pixels that no ray with
  /// light has reached have an error, although its estimate is 0. Above a hundredth, values marked
  /// * mean little, unless these pixels are truly dark.
  double dark_in_one_share = 0;

  static constexpr int kBlock = 16;
};

/// The verdict of a comparison about the cause of the differences.
enum class Verdict {
  unknown,         ///< no standard errors, or too few rays for them (kTooManyDark)
  noise,           ///< nothing speaks against noise alone
  more_than_noise  ///< the bias, a block score or a single pixel is beyond its limit
};

/// Limits of verdict(): standard errors of the bias, and block_score. Noise alone exceeds them
/// about once in two million comparisons.
inline constexpr double kVerdictLimit = 5;
/// A single pixel counts when largest_z_probability is at most this ...
inline constexpr double kVerdictProbability = 1e-6;
/// ... and its error has at least this number of degrees of freedom. With fewer, the mean square of
/// the normalised differences has no finite mean or no finite variance.
inline constexpr double kFreedomForPixels = 5;
/// Above this share of pixels that are dark in one image, only the standard errors of single pixels
/// are too small. The images still differ if their means or neighbours do ...
inline constexpr double kTooManyDark = 0.01;
/// ... and each mean is known this well (mean_error), as from 25 rays with light.
inline constexpr double kKnownMean = 0.2;

Verdict verdict(const Comparison& comparison);

/// Compares channel `channel` (empty: the first of `reference`) of a light field with a reference.
/// @throws InputError when sensors differ, windows don't overlap, a channel is missing (the message
///         lists those present), the reference is dark, or a pixel isn't finite
Comparison compare(const LightField& a, const LightField& reference,
                   const std::string& channel = "");

}  // namespace plenoflame
