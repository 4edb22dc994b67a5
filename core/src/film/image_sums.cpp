#include "film/image_sums.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "film/error_bound.h"

namespace plenoflame {
namespace {

constexpr int kRows = 64;  ///< of a part of a whole picture

/// Has `measure` look at each part. @return what it found, in the order of the parts
template <class Result, class Measure>
std::vector<Result> of_parts(const ImageParts& parts, const Execution& execution,
                             const Measure& measure) {
  std::vector<Result> results(parts.size());
  parallel_for(execution.threads_only(), parts.size(),
               [&](std::size_t i, int) { results[i] = measure(parts[i]); });
  return results;
}

/// Independent partial sums: a single sum would wait for each of its additions.
constexpr std::size_t kLanes = 8;
using Lanes = std::array<double, kLanes>;

double total(const Lanes& lanes) {
  double sum = 0;
  for (const double lane : lanes) sum += lane;
  return sum;
}

/// Over the pixels that are lit.
struct LitSums {
  Lanes squares{}, fourth{}, eighth{};  ///< of the standard errors
  Lanes total{};                        ///< of the flux
  Lanes pixels{};                       ///< that are lit
  Lanes may_be{};                       ///< that may be lit
};

/// Pixels above `limit` are lit, those within two standard errors of it may be.
void add_lit(double flux, double error, double limit, std::size_t lane, LitSums& sums) {
  if (flux + 2 * error > limit) sums.may_be[lane] += 1;
  if (!(flux > limit)) return;
  const double square = error * error;
  sums.squares[lane] += square;
  const double fourth = square * square;
  sums.fourth[lane] += fourth;
  sums.eighth[lane] += fourth * fourth;
  sums.total[lane] += flux;
  sums.pixels[lane] += 1;
}

/// Calls `take` with a lane and the number of a pixel, for all lit runs.
template <class Take>
void for_pixels(const Image& image, const PixelWindow& part, const Take& take) {
  for_lit_runs(image, part, [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) take((i - first) % kLanes, i);
  });
}

}  // namespace

ImageParts whole_of(const Image& image) {
  ImageParts parts;
  for (int row = 0; row < image.height; row += kRows)
    parts.push_back({0, row, image.width, std::min(kRows, image.height - row)});
  return parts;
}

float largest_of(const Image& image, const ImageParts& parts, const Execution& execution) {
  float largest = 0;
  for (const float of_part : of_parts<float>(parts, execution, [&](const PixelWindow& part) {
         std::array<float, kLanes> most{};
         for_pixels(image, part, [&](std::size_t lane, std::size_t i) {
           most[lane] = std::max(most[lane], image.pixels[i]);
         });
         return *std::max_element(most.begin(), most.end());
       }))
    largest = std::max(largest, of_part);
  return largest;
}

double sum_of(const Image& image, const ImageParts& parts, const Execution& execution) {
  double sum = 0;
  for (const double of_part : of_parts<double>(parts, execution, [&](const PixelWindow& part) {
         Lanes sums{};
         for_pixels(image, part, [&](std::size_t lane, std::size_t i) {
           sums[lane] += static_cast<double>(image.pixels[i]);
         });
         return total(sums);
       }))
    sum += of_part;
  return sum;
}

StatedError stated_error(const Image& flux, const Image& standard_error, int replicates,
                         const ImageParts& parts, const Execution& execution) {
  StatedError stated;
  if (flux.empty()) return stated;
  if (standard_error.empty() || replicates < 2) {
    stated.bound = std::numeric_limits<double>::infinity();
    return stated;
  }
  const auto largest = static_cast<double>(largest_of(flux, parts, execution));
  if (!(largest > 0)) return stated;
  // Eighth powers of the smallest errors would be 0. A power of two, so that no digit is lost.
  const double unit = std::isfinite(largest) ? std::ldexp(1.0, -std::ilogb(largest)) : 1.0;
  const double limit = unit * kLitShare * largest;
  struct {
    double squares = 0, fourth = 0, eighth = 0, total = 0, pixels = 0, may_be = 0;
  } sums;
  for (const LitSums& part : of_parts<LitSums>(parts, execution, [&](const PixelWindow& window) {
         LitSums of_part{};
         // There is no scatter without flux.
         for_pixels(flux, window, [&](std::size_t lane, std::size_t i) {
           add_lit(unit * static_cast<double>(flux.pixels[i]),
                   unit * static_cast<double>(standard_error.pixels[i]), limit, lane, of_part);
         });
         return of_part;
       })) {
    sums.squares += total(part.squares);
    sums.fourth += total(part.fourth);
    sums.eighth += total(part.eighth);
    sums.total += total(part.total);
    sums.pixels += total(part.pixels);
    sums.may_be += total(part.may_be);
  }
  if (!(sums.pixels > 0)) return stated;
  stated.relative_rmse = std::sqrt(sums.squares * sums.pixels) / sums.total;
  if (std::isnan(sums.squares)) stated.bound = std::numeric_limits<double>::infinity();
  if (!(sums.squares > 0)) return stated;
  // Let the errors of variances v_i be normal. The sums of (image - truth)^2 and of the squared
  // standard errors are then both distributed as v chi^2 / n. Here n is (sum v)^2 / sum v^2, with n
  // (R - 1) degrees of freedom (Welch-Satterthwaite).
  const double r = replicates;
  const double freedom =
      effective_pixels(sums.squares, sums.fourth, sums.eighth, sums.pixels, r - 1);
  stated.bound = std::sqrt(sums.squares * sums.may_be *
                           f_quantile(kErrorConfidence, freedom, freedom * (r - 1))) /
                 sums.total;
  return stated;
}

StatedError stated_error(const Image& flux, const Image& standard_error, int replicates) {
  Execution alone;
  alone.threads = 1;
  return stated_error(flux, standard_error, replicates, whole_of(flux), alone);
}

}  // namespace plenoflame
