#include "film/image_sums.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "film/error_bound.h"

namespace plenoflame {
namespace {

constexpr int kRows = 64;             ///< of a part of a whole picture
constexpr double kMostFreedom = 1e6;  ///< more change the bound by less than 0.2 %

/// Has `measure` look at each part. @return what it found, in the order of the parts
template <class Result, class Measure>
std::vector<Result> of_parts(const ImageParts& parts, const Execution& execution,
                             const Measure& measure) {
  std::vector<Result> results(parts.size());
  // What has been gathered is wanted also after a stop.
  Execution inner;
  inner.threads = execution.threads;
  parallel_for(inner, parts.size(), [&](std::size_t i, int) { results[i] = measure(parts[i]); });
  return results;
}

/// Sums go on side by side: one alone would wait for each of its additions.
constexpr std::size_t kLanes = 8;
static_assert(kRun % kLanes == 0);
using Lanes = std::array<double, kLanes>;

double total(const Lanes& lanes) {
  double sum = 0;
  for (const double lane : lanes) sum += lane;
  return sum;
}

/// Calls `take` with a lane and a pixel's number, for all pixels of lit runs.
template <class Take>
void for_lit_lanes(const Image& image, const PixelWindow& part, const Take& take) {
  for_lit_runs(image, part, [&](std::size_t first, std::size_t end) {
    for (; first + kLanes <= end; first += kLanes)
      for (std::size_t lane = 0; lane < kLanes; ++lane) take(lane, first + lane);
    for (std::size_t lane = 0; first < end; ++lane, ++first) take(lane, first);
  });
}

/// Over the lit pixels of a part.
struct LitSums {
  Lanes squares{}, fourth{};  ///< of the standard errors
  Lanes total{};              ///< of the flux
  Lanes pixels{}, may_be{};   ///< that are lit, and that may be
};

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
         const float* pixels = image.pixels.data();
         for_lit_lanes(image, part, [&](std::size_t lane, std::size_t i) {
           most[lane] = pixels[i] > most[lane] ? pixels[i] : most[lane];
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
         const float* pixels = image.pixels.data();
         for_lit_lanes(image, part, [&](std::size_t lane, std::size_t i) {
           sums[lane] += static_cast<double>(pixels[i]);
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
  const double limit = kLitShare * static_cast<double>(largest_of(flux, parts, execution));
  struct {
    double squares = 0, fourth = 0, total = 0, pixels = 0, may_be = 0;
  } sums;
  const float* of_flux = flux.pixels.data();
  const float* of_error = standard_error.pixels.data();
  for (const LitSums& part : of_parts<LitSums>(parts, execution, [&](const PixelWindow& window) {
         LitSums of_part;
         // Where there is no flux there is no scatter.
         for_lit_lanes(flux, window, [&](std::size_t lane, std::size_t i) {
           const double f = static_cast<double>(of_flux[i]), e = static_cast<double>(of_error[i]);
           const bool is_lit = f > limit;
           const double e2 = is_lit ? e * e : 0;
           of_part.squares[lane] += e2;
           of_part.fourth[lane] += e2 * e2;
           of_part.total[lane] += is_lit ? f : 0;
           of_part.pixels[lane] += is_lit ? 1 : 0;
           of_part.may_be[lane] += f + 2 * e > limit ? 1 : 0;
         });
         return of_part;
       })) {
    sums.squares += total(part.squares);
    sums.fourth += total(part.fourth);
    sums.total += total(part.total);
    sums.pixels += total(part.pixels);
    sums.may_be += total(part.may_be);
  }
  if (!(sums.pixels > 0)) return stated;
  stated.relative_rmse = std::sqrt(sums.squares * sums.pixels) / sums.total;
  if (!(sums.squares > 0)) return stated;
  // For normal errors of variances v_i the sums of (image - truth)^2 and of the squared standard
  // errors are both like v times chi^2 / n with n = (sum v)^2 / sum v^2 and n (R - 1) degrees of
  // freedom (Welch-Satterthwaite); the expectation of e^4 is v^2 (R + 1)/(R - 1). There are no more
  // than there are pixels, which an estimate from few pixels may say.
  const double r = replicates;
  const double freedom = std::clamp(sums.squares * sums.squares * (r + 1) / ((r - 1) * sums.fourth),
                                    1.0, std::min(kMostFreedom, sums.pixels));
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
