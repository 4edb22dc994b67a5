#include "film/image_sums.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/isa_dispatch.h"
#include "film/error_bound.h"
#include "film/picture_sums_kernel.h"
#include "plenoflame/base/isa.h"

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

using Lanes = std::array<double, kSumLanes>;

template <class Numbers>
double total(const Numbers& lanes) {
  double sum = 0;
  for (const double lane : lanes) sum += lane;
  return sum;
}

struct PictureSumsKernels {
  void (*add_lit)(const float*, const float*, int, double, LitSums&);
  void (*add_pixels)(const float*, int, double*);
  void (*keep_largest)(const float*, int, float*);
};

PictureSumsKernels sums_kernels(Isa isa) {
  PLENOFLAME_DISPATCH(isa, return {kernels::add_lit, kernels::add_pixels, kernels::keep_largest};)
}

/// Calls `take` with numbers of pixels and how many they are, for all lit runs.
template <class Take>
void for_runs(const Image& image, const PixelWindow& part, const Take& take) {
  for_lit_runs(image, part, [&](std::size_t first, std::size_t end) {
    take(first, static_cast<int>(end - first));
  });
}

}  // namespace

ImageParts whole_of(const Image& image) {
  ImageParts parts;
  for (int row = 0; row < image.height; row += kRows)
    parts.push_back({0, row, image.width, std::min(kRows, image.height - row)});
  return parts;
}

float largest_of(const Image& image, const ImageParts& parts, const Execution& execution, Isa isa) {
  const auto keep_largest = sums_kernels(isa).keep_largest;
  float largest = 0;
  for (const float of_part : of_parts<float>(parts, execution, [&](const PixelWindow& part) {
         std::array<float, kSumLanes> most{};
         for_runs(image, part, [&](std::size_t first, int count) {
           keep_largest(image.pixels.data() + first, count, most.data());
         });
         return *std::max_element(most.begin(), most.end());
       }))
    largest = std::max(largest, of_part);
  return largest;
}

double sum_of(const Image& image, const ImageParts& parts, const Execution& execution, Isa isa) {
  const auto add_pixels = sums_kernels(isa).add_pixels;
  double sum = 0;
  for (const double of_part : of_parts<double>(parts, execution, [&](const PixelWindow& part) {
         Lanes sums{};
         for_runs(image, part, [&](std::size_t first, int count) {
           add_pixels(image.pixels.data() + first, count, sums.data());
         });
         return total(sums);
       }))
    sum += of_part;
  return sum;
}

StatedError stated_error(const Image& flux, const Image& standard_error, int replicates,
                         const ImageParts& parts, const Execution& execution, Isa isa) {
  StatedError stated;
  if (flux.empty()) return stated;
  if (standard_error.empty() || replicates < 2) {
    stated.bound = std::numeric_limits<double>::infinity();
    return stated;
  }
  const double limit = kLitShare * static_cast<double>(largest_of(flux, parts, execution, isa));
  struct {
    double squares = 0, fourth = 0, total = 0, pixels = 0, may_be = 0;
  } sums;
  const auto add_lit = sums_kernels(isa).add_lit;
  const float* of_flux = flux.pixels.data();
  const float* of_error = standard_error.pixels.data();
  for (const LitSums& part : of_parts<LitSums>(parts, execution, [&](const PixelWindow& window) {
         LitSums of_part{};
         // Where there is no flux there is no scatter.
         for_runs(flux, window, [&](std::size_t first, int count) {
           add_lit(of_flux + first, of_error + first, count, limit, of_part);
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
  if (std::isnan(sums.squares)) stated.bound = std::numeric_limits<double>::infinity();
  if (!(sums.squares > 0)) return stated;
  // For normal errors of variances v_i the sums of (image - truth)^2 and of the squared standard
  // errors are both like v times chi^2 / n with n = (sum v)^2 / sum v^2 and n (R - 1) degrees of
  // freedom (Welch-Satterthwaite).
  const double r = replicates;
  const double freedom = effective_pixels(sums.squares, sums.fourth, sums.pixels, r - 1);
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
