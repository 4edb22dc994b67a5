#include "film/image_sums.h"

#include <algorithm>
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

/// Over the lit pixels of a part.
struct LitSums {
  double squares = 0, fourth = 0;  ///< of the standard errors
  double total = 0;                ///< of the flux
  double pixels = 0, may_be = 0;   ///< that are lit, and that may be
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
         float most = 0;
         for_lit_runs(image, part, [&](std::size_t first, std::size_t end) {
           for (std::size_t i = first; i < end; ++i) most = std::max(most, image.pixels[i]);
         });
         return most;
       }))
    largest = std::max(largest, of_part);
  return largest;
}

double sum_of(const Image& image, const ImageParts& parts, const Execution& execution) {
  double sum = 0;
  for (const double of_part : of_parts<double>(parts, execution, [&](const PixelWindow& part) {
         double total = 0;
         for_lit_runs(image, part, [&](std::size_t first, std::size_t end) {
           for (std::size_t i = first; i < end; ++i) total += static_cast<double>(image.pixels[i]);
         });
         return total;
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
  LitSums sums;
  for (const LitSums& part : of_parts<LitSums>(parts, execution, [&](const PixelWindow& window) {
         LitSums of_part;
         // Where there is no flux there is no scatter.
         for_lit_runs(flux, window, [&](std::size_t first, std::size_t end) {
           for (std::size_t i = first; i < end; ++i) {
             const double f = static_cast<double>(flux.pixels[i]);
             const double e = static_cast<double>(standard_error.pixels[i]);
             if (f + 2 * e > limit) of_part.may_be += 1;
             if (!(f > limit)) continue;
             const double e2 = e * e;
             of_part.squares += e2;
             of_part.fourth += e2 * e2;
             of_part.total += f;
             of_part.pixels += 1;
           }
         });
         return of_part;
       })) {
    sums.squares += part.squares;
    sums.fourth += part.fourth;
    sums.total += part.total;
    sums.pixels += part.pixels;
    sums.may_be += part.may_be;
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
