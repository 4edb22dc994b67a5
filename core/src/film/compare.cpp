#include "plenoflame/film/compare.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "film/error_bound.h"
#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

PixelWindow common_window(const PixelWindow& a, const PixelWindow& b) {
  const int x = std::max(a.x, b.x), y = std::max(a.y, b.y);
  return {x, y, std::min(a.x + a.width, b.x + b.width) - x,
          std::min(a.y + a.height, b.y + b.height) - y};
}

/// One image of a light field, addressed by columns and rows of the sensor.
class SensorImage {
 public:
  SensorImage(const Image& image, const PixelWindow& window) : image_(image), window_(window) {}
  bool empty() const { return image_.empty(); }
  double at(int column, int row) const {
    return empty() ? 0.0 : static_cast<double>(image_.at(column - window_.x, row - window_.y));
  }

 private:
  const Image& image_;
  const PixelWindow& window_;
};

void check_finite(double flux, double error, int column, int row, const char* which) {
  if (std::isfinite(flux) && std::isfinite(error)) return;
  throw InputError(std::string(which) + " holds a value that is not finite, in column " +
                   std::to_string(column) + ", row " + std::to_string(row));
}

/// Normal score of a chi-square sum with n degrees of freedom, by Wilson and Hilferty.
double normal_score(double sum, double n) {
  const double variance = 2.0 / (9.0 * n);
  return (std::cbrt(sum / n) - (1.0 - variance)) / std::sqrt(variance);
}

/// Degrees of freedom of the standard errors, of the image with the fewest replicates. Infinite if
/// no image has their number.
double fewest_freedom(const LightField& a, bool a_counts, const LightField& b, bool b_counts) {
  double freedom = std::numeric_limits<double>::infinity();
  const auto take = [&](const LightField& field, bool counts) {
    const auto replicates = field.numbers.find("render.replicates");
    if (counts && replicates != field.numbers.end() && replicates->second >= 2)
      freedom = std::min(freedom, replicates->second - 1);
  };
  take(a, a_counts);
  take(b, b_counts);
  return freedom;
}

/// Probability that the largest of n numbers of Student's distribution (infinite freedom: of the
/// normal one) is at least |z| in magnitude.
double largest_probability(double z, double n, double freedom) {
  const double one =
      std::isfinite(freedom) ? student_tail(z, freedom) : std::erfc(std::fabs(z) / std::sqrt(2.0));
  return one >= 1 ? 1 : -std::expm1(n * std::log1p(-one));
}

/// Mean of the squared standard errors over the common window [W^2]; 0 without them.
double mean_variance(const SensorImage& error, const PixelWindow& window) {
  double sum = 0;
  for (int row = window.y; row < window.y + window.height; ++row)
    for (int column = window.x; column < window.x + window.width; ++column)
      sum += error.at(column, row) * error.at(column, row);
  return sum / window.width / window.height;
}

/// Tells which pixels are lit. A weighted mean of both images selects them; each image has the
/// weight of the other's variance, the same in all pixels. The noise of this mean is not correlated
/// with that of the difference: E[(v_b e_a + v_a e_b)(e_a - e_b)] = v_b v_a - v_a v_b = 0. One
/// image alone would select pixels in which it is too bright and skip those in which it is too
/// dark.
class LitChoice {
 public:
  LitChoice(const SensorImage& a, const SensorImage& b, double variance_a, double variance_b,
            const PixelWindow& window) {
    const double sum = variance_a + variance_b;
    const auto largest = [&] {
      double most = 0;
      for (int row = window.y; row < window.y + window.height; ++row)
        for (int column = window.x; column < window.x + window.width; ++column)
          most = std::max(most, mean(a.at(column, row), b.at(column, row)));
      return most;
    };
    share_a_ = sum > 0 ? variance_b / sum : 0.5;
    above_ = kLitShare * largest();
    if (above_ > 0) return;
    // An image in which no ray found light seems to be exact, and would decide alone.
    share_a_ = 0.5;
    above_ = kLitShare * largest();
  }
  /// Flux above which a pixel is lit.
  double above() const { return above_; }
  bool operator()(double a, double b) const { return mean(a, b) > above_; }

 private:
  double mean(double a, double b) const { return share_a_ * a + (1 - share_a_) * b; }
  double share_a_ = 0.5, above_ = 0;
};

/// Tells whether differences are alike among the pixels of a block. If they are independent, and 0
/// in the mean, the square of their sum has the sum of their squares as its mean. Its variance is
/// known as well, for differences of any size and distribution. This holds for sums over blocks
/// with weights that do not depend on the differences. It does not hold for ratios: large errors of
/// one sign increase both numerator and denominator.
class BlockTest {
 public:
  struct Pixel {
    double difference, flux, variance;
  };
  void add(const Pixel& pixel) {
    const double square = pixel.difference * pixel.difference;
    sum_ += pixel.difference;
    squares_ += square;
    fourth_ += square * square;
    flux_ += pixel.flux;
    variance_ += pixel.variance;
  }

  /// Sums over blocks, weighted by the inverse of their flux, as errors go about as its root.
  struct Sums {
    double squares = 0, excess = 0, variance = 0;
    std::size_t blocks = 0;

    double chi_square() const { return 1 + excess / squares; }
    /// As of a multiple of chi-square with this mean and variance.
    double score() const {
      if (!(variance > 0)) return 0;
      const double per_variance = 2 * squares / variance;
      return normal_score((squares + excess) * per_variance, squares * per_variance);
    }
  };
  /// Ends a block. @param dark flux of a dark one: weights of darker ones are no larger
  void close(double dark, Sums& sums) {
    // Differences that are smaller than the noise are taken as parts of it.
    const double weight = 1 / std::max(dark, flux_),
                 squares = weight * std::max(squares_, variance_);
    if (squares > 0) {
      sums.squares += squares;
      sums.excess += weight * (sum_ * sum_ - squares_);
      const double equal = squares_ > 0 ? 1 - fourth_ / (squares_ * squares_) : 1;
      sums.variance += 2 * squares * squares * equal;
      ++sums.blocks;
    }
    *this = {};
  }

 private:
  double sum_ = 0, squares_ = 0, fourth_ = 0, flux_ = 0, variance_ = 0;
};

/// Relative error of a sum with this variance. A picture in which no ray found light is as it is.
double relative_error(double variance, double sum) {
  return sum > 0 ? std::sqrt(variance) / sum : 0;
}

}  // namespace

Verdict verdict(const Comparison& c) {
  if (!c.has_standard_errors) return Verdict::unknown;
  const bool doubtful = c.dark_in_one_share > kTooManyDark;
  const bool biased = std::fabs(c.relative_bias) > kVerdictLimit * c.relative_bias_error;
  const bool pixel =
      !doubtful && c.freedom >= kFreedomForPixels && c.largest_z_probability < kVerdictProbability;
  const bool differ = biased || pixel || c.block_score > kVerdictLimit;
  if (doubtful)
    return differ && c.mean_error < kKnownMean ? Verdict::more_than_noise : Verdict::unknown;
  return differ ? Verdict::more_than_noise : Verdict::noise;
}

Comparison compare(const LightField& a, const LightField& reference, const std::string& channel) {
  if (a.sensor_width != reference.sensor_width || a.sensor_height != reference.sensor_height)
    throw InputError("the images are of different sensors: " + std::to_string(a.sensor_width) +
                     " x " + std::to_string(a.sensor_height) + " and " +
                     std::to_string(reference.sensor_width) + " x " +
                     std::to_string(reference.sensor_height) + " pixels");
  Comparison result;
  const PixelWindow window = common_window(a.window, reference.window);
  if (window.width <= 0 || window.height <= 0)
    throw InputError("the images have no pixel in common: their windows don't overlap");
  result.window = window;
  if (a.unit != reference.unit)
    result.caution = "the first image is in " + a.unit + ", the reference in " + reference.unit +
                     ": their difference means nothing";
  const LightFieldChannel& channel_b = find_channel(reference, channel, "the reference");
  const LightFieldChannel& channel_a = find_channel(a, channel_b.name, "the first image");
  const SensorImage flux_a(channel_a.flux, a.window), flux_b(channel_b.flux, reference.window);
  const SensorImage error_a(channel_a.standard_error, a.window);
  const SensorImage error_b(channel_b.standard_error, reference.window);
  if (flux_a.empty() || flux_b.empty()) throw InputError("an image was read without its pixels");
  result.has_standard_errors = !error_a.empty() || !error_b.empty();

  result.freedom = fewest_freedom(a, !error_a.empty(), reference, !error_b.empty());
  const LitChoice lit(flux_a, flux_b, mean_variance(error_a, window),
                      mean_variance(error_b, window), window);
  constexpr int kBlock = Comparison::kBlock;
  // Half a unit in the last place of single precision: values were rounded when stored.
  constexpr double kRounding = 0x1p-24;
  double sum_a = 0, sum_b = 0, difference_sum = 0, square_sum = 0, variance_sum = 0;
  double variance_a = 0, variance_b = 0;
  double flux = 0, stray = 0, chi_sum = 0;
  BlockTest::Sums block_sums;
  const double dark_block = lit.above() * kBlock * kBlock;
  double lit_in_either = 0, dark_in_one = 0;
  std::vector<BlockTest> blocks(static_cast<std::size_t>((window.width + kBlock - 1) / kBlock));
  for (int y = 0; y < window.height; ++y) {
    for (int x = 0; x < window.width; ++x) {
      const int column = window.x + x, row = window.y + y;
      const double va = flux_a.at(column, row), vb = flux_b.at(column, row);
      const double ea = error_a.at(column, row), eb = error_b.at(column, row);
      check_finite(va, ea, column, row, "the first image");
      check_finite(vb, eb, column, row, "the reference");
      const double difference = va - vb;
      flux += va;
      if (std::fabs(difference) > std::fabs(result.largest_difference)) {
        result.largest_difference = difference;
        result.largest_column = column;
        result.largest_row = row;
      }
      const double rounding = kRounding * kRounding * (va * va + vb * vb);
      const double variance = result.has_standard_errors ? ea * ea + eb * eb + rounding : 0;
      if (std::max(va, vb) > lit.above()) {
        lit_in_either += 1;
        dark_in_one += va == 0 || vb == 0 ? 1 : 0;
      }
      if (lit(va, vb)) {
        ++result.lit_pixels;
        sum_a += va;
        sum_b += vb;
        difference_sum += difference;
        square_sum += difference * difference;
        variance_sum += variance;
        variance_a += ea * ea;
        variance_b += eb * eb;
      } else {
        stray += va;
      }
      if (result.has_standard_errors)
        blocks[static_cast<std::size_t>(x / kBlock)].add({difference, va + vb, variance});
      if (!(variance > 0)) continue;
      const double z = difference / std::sqrt(variance);
      chi_sum += z * z;
      ++result.chi_square_pixels;
      if (std::fabs(z) > std::fabs(result.largest_z)) {
        result.largest_z = z;
        result.largest_z_column = column;
        result.largest_z_row = row;
      }
    }
    if ((y + 1) % kBlock != 0 && y + 1 != window.height) continue;
    for (BlockTest& block : blocks) block.close(dark_block, block_sums);
  }
  if (!(sum_b > 0))
    throw InputError("the reference is dark: no pixel in common has a flux above 0");

  const auto n = static_cast<double>(result.lit_pixels);
  result.mean = sum_a / n;
  result.reference_mean = sum_b / n;
  result.relative_rmse = std::sqrt(square_sum / n) / result.reference_mean;
  result.relative_bias = difference_sum / n / result.reference_mean;
  result.stray_share = flux > 0 ? stray / flux : 0;
  result.dark_in_one_share = dark_in_one / lit_in_either;
  if (result.chi_square_pixels > 0) {
    const auto pixels = static_cast<double>(result.chi_square_pixels);
    result.relative_bias_error = std::sqrt(variance_sum) / n / result.reference_mean;
    result.mean_error =
        std::max(relative_error(variance_a, sum_a), relative_error(variance_b, sum_b));
    result.expected_rmse = std::sqrt(variance_sum / n) / result.reference_mean;
    result.largest_z_probability = largest_probability(result.largest_z, pixels, result.freedom);
    result.chi_square = chi_sum / pixels;
    result.blocks = block_sums.blocks;
    result.block_chi_square = block_sums.chi_square();
    result.block_score = block_sums.score();
  }
  return result;
}

}  // namespace plenoflame
