#include "plenoflame/calibration/radiometry_fit.h"

#include <algorithm>
#include <cmath>

#include "calibration/even_factors.h"
#include "plenoflame/base/error.h"
#include "plenoflame/lightfield/sensor.h"

namespace plenoflame {
namespace {

/// A picture, added up over the evaluated pixels.
struct PictureSums {
  double counts = 0;  ///< mean above dark
  double square = 0;  ///< mean of the counts' squares, weighted as in a fit of the curvature
  double ratio = 0;   ///< sum of counts over sum of expected energies, or of etendue times time
  double error = 0;   ///< relative standard error of the ratio, of noise
};

std::vector<std::size_t> chosen_pixels(const std::vector<SourcePicture>& pictures,
                                       const EvaluatedPixels& pixels,
                                       const std::vector<float>& factors) {
  double brightest = 0;
  for (const float value : pixels.etendue.pixels)
    brightest = std::max(brightest, static_cast<double>(value));
  std::vector<std::size_t> chosen;
  const PixelWindow& part = pixels.part;
  for (int row = 0; row < pixels.window.height; ++row)
    for (int column = 0; column < pixels.window.width; ++column) {
      const int x = pixels.window.x + column, y = pixels.window.y + row;
      if (x < part.x || y < part.y || x >= part.x + part.width || y >= part.y + part.height)
        continue;
      if (mosaic_colour(pixels.mosaic, x, y) != pixels.colour) continue;
      // Near the rims of micro-images model and camera differ first.
      if (static_cast<double>(pixels.etendue.at(column, row)) < 0.8 * brightest) continue;
      const auto at =
          static_cast<std::size_t>(row) * static_cast<std::size_t>(pixels.window.width) +
          static_cast<std::size_t>(column);
      const bool good = std::all_of(pictures.begin(), pictures.end(), [&](const SourcePicture& p) {
        return p.frames->state[at] == 0;
      });
      if (good && (factors.empty() || factors[at] > 0)) chosen.push_back(at);
    }
  return chosen;
}

double dark_at(const CountFrames* dark, const EvaluatedPixels& pixels, std::size_t at,
               double black_level) {
  return dark != nullptr ? static_cast<double>(dark->mean[pixels.channel].pixels[at]) : black_level;
}

/// By what each pixel's light is multiplied, flat field and white picture together; not above 0:
/// the pixel is left out. Empty: there are no corrections.
std::vector<float> factors_of(const EvaluatedPixels& pixels, double curvature) {
  const RawCorrections& corrections = pixels.corrections;
  std::vector<float> factors;
  const auto even_out = [&](const CountFrames* frames, const CountFrames* dark,
                            const Image* expected) {
    if (frames == nullptr) return;
    const auto width = static_cast<std::size_t>(pixels.window.width);
    const EvenFactors even = even_factors(
        *frames, expected, pixels.mosaic == MosaicPattern::none ? 1 : 3,
        [&](std::size_t i) {
          return static_cast<std::size_t>(
              mosaic_colour(pixels.mosaic, pixels.window.x + static_cast<int>(i % width),
                            pixels.window.y + static_cast<int>(i / width)));
        },
        [&](std::size_t i) {
          const double counts = static_cast<double>(frames->mean[pixels.channel].pixels[i]);
          const double level = dark_at(dark, pixels, i, pixels.sensor.black_level);
          double light = counts - level;
          double variance =
              sensor_variance(*frames, counts - pixels.sensor.black_level, pixels.sensor);
          if (dark != nullptr)
            variance += sensor_variance(*dark, level - pixels.sensor.black_level, pixels.sensor);
          make_linear(curvature, light, variance);
          return std::pair{light, variance};
        });
    if (factors.empty()) factors.assign(even.factors.size(), 1.0F);
    for (std::size_t i = 0; i < factors.size(); ++i)
      factors[i] = factors[i] > 0 && even.factors[i] > 0 ? factors[i] * even.factors[i] : 0.0F;
  };
  even_out(corrections.flat, corrections.flat_dark, nullptr);
  even_out(corrections.white, corrections.white_dark, &pixels.etendue);
  return factors;
}

/// @param factors  of factors_of()
/// @param radiance of the picture, or 1 where it is not known
PictureSums sums_of(const SourcePicture& picture, const EvaluatedPixels& pixels,
                    const std::vector<std::size_t>& chosen, const std::vector<float>& factors,
                    double radiance) {
  if (!(picture.exposure_time > 0)) throw InputError("a picture's exposure time is not known");
  const auto counts_of = [&](std::size_t at) {
    return static_cast<double>(picture.frames->mean[pixels.channel].pixels[at]) -
           dark_at(picture.dark, pixels, at, picture.black_level);
  };
  const auto factor_of = [&](std::size_t at) {
    return factors.empty() ? 1 : static_cast<double>(factors[at]);
  };
  double counts = 0, squares = 0, energy = 0, scatter = 0;
  for (const std::size_t at : chosen) {
    const double c = counts_of(at), factor = factor_of(at);
    counts += factor * c;
    squares += factor * c * c;
    energy += static_cast<double>(pixels.etendue.pixels[at]) * radiance * picture.exposure_time;
  }
  PictureSums sums;
  const auto n = static_cast<double>(chosen.size());
  sums.counts = counts / n;
  if (!(counts > 0))
    throw InputError("a picture is no brighter than its dark frame in the evaluated pixels");
  sums.square = squares / counts;
  sums.ratio = counts / energy;
  // The pixels' own gains differ, and counts have noise: both are in the scatter of the ratios.
  for (const std::size_t at : chosen) {
    const double c = factor_of(at) * counts_of(at);
    const double expected = sums.ratio * static_cast<double>(pixels.etendue.pixels[at]) * radiance *
                            picture.exposure_time;
    scatter += (c - expected) * (c - expected);
  }
  sums.error = std::sqrt(scatter) / counts;
  return sums;
}

/// 1 / ratio = j (1 + k counts): weighted least squares.
struct LineFit {
  double j = 0, j_variance = 0, k = 0, k_variance = 0, chi_squared = 0;

  /// By how much a picture's ratio is above the line, relative.
  double off(const PictureSums& one) const { return one.ratio * j * (1 + k * one.square) - 1; }
};

LineFit fit_line(const std::vector<PictureSums>& sums, const std::vector<double>& relative,
                 bool with_curvature, double known_curvature, double known_variance) {
  LineFit fit;
  double s = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t p = 0; p < sums.size(); ++p) {
    const double x = sums[p].square;
    const double y = 1 / sums[p].ratio / (with_curvature ? 1 : 1 + known_curvature * x);
    const double error = std::hypot(relative[p], sums[p].error) * y;
    const double w = 1 / (error * error);
    s += w;
    sx += w * x;
    sy += w * y;
    sxx += w * x * x;
    sxy += w * x * y;
  }
  if (!with_curvature) {
    fit.j = sy / s;
    const double of_curvature = fit.j * sx / s;
    fit.j_variance = 1 / s + of_curvature * of_curvature * known_variance;
    fit.k = known_curvature;
    fit.k_variance = known_variance;
  } else {
    const double determinant = s * sxx - sx * sx;
    const double slope = (s * sxy - sx * sy) / determinant;
    fit.j = (sxx * sy - sx * sxy) / determinant;
    fit.j_variance = sxx / determinant;
    fit.k = slope / fit.j;
    fit.k_variance = s / determinant / (fit.j * fit.j);
  }
  for (std::size_t p = 0; p < sums.size(); ++p)
    fit.chi_squared += std::pow(fit.off(sums[p]) / std::hypot(relative[p], sums[p].error), 2);
  return fit;
}

/// True if counts differ enough to determine a curvature.
bool spans(const std::vector<PictureSums>& sums) {
  if (sums.size() < 3) return false;
  double low = 1e300, high = 0;
  for (const PictureSums& one : sums) {
    low = std::min(low, one.counts);
    high = std::max(high, one.counts);
  }
  return high > 2 * low;
}

/// The fit with factors of flat field and white picture that are known.
RadiometryFit fit_with(const std::vector<float>& factors, const std::vector<SourcePicture>& sources,
                       const std::vector<SourcePicture>& whites, const EvaluatedPixels& pixels,
                       double common) {
  std::vector<SourcePicture> all = sources;
  all.insert(all.end(), whites.begin(), whites.end());
  const std::vector<std::size_t> chosen = chosen_pixels(all, pixels, factors);
  if (chosen.size() < 20)
    throw InputError(
        "fewer than 20 pixels are left that see all of the stop and are not saturated");
  RadiometryFit result;
  result.pixels = chosen.size();
  std::vector<PictureSums> of_sources, of_whites;
  std::vector<double> errors, no_errors;
  for (const SourcePicture& picture : sources) {
    of_sources.push_back(sums_of(picture, pixels, chosen, factors, picture.radiance));
    errors.push_back(picture.radiance_error);
  }
  for (const SourcePicture& picture : whites) {
    of_whites.push_back(sums_of(picture, pixels, chosen, factors, 1));
    no_errors.push_back(0);
  }
  double curvature = 0, curvature_variance = 0;
  const bool by_whites = spans(of_whites);
  if (by_whites) {
    const LineFit line = fit_line(of_whites, no_errors, true, 0, 0);
    curvature = line.k;
    curvature_variance = line.k_variance;
    for (const PictureSums& one : of_whites) {
      const double off = line.off(one);
      result.whites.push_back({one.counts, off, off / one.error});
    }
  }
  const bool own = !by_whites && spans(of_sources);
  const LineFit line = fit_line(of_sources, errors, own, curvature, curvature_variance);
  for (std::size_t p = 0; p < of_sources.size(); ++p) {
    const double off = line.off(of_sources[p]);
    result.sources.push_back(
        {of_sources[p].counts, off, off / std::hypot(errors[p], of_sources[p].error)});
  }
  const std::size_t free = of_sources.size() - (own ? 2 : 1);
  if (free > 0) result.chi_squared = line.chi_squared / static_cast<double>(free);
  result.scale.joules_per_count = line.j;
  result.scale.relative_error = std::hypot(std::sqrt(line.j_variance) / line.j, common);
  result.scale.curvature = line.k;
  result.scale.curvature_error = std::sqrt(line.k_variance);
  return result;
}

}  // namespace

RadiometryFit fit_radiometry(const std::vector<SourcePicture>& sources,
                             const std::vector<SourcePicture>& whites,
                             const EvaluatedPixels& pixels, double common) {
  if (sources.empty()) throw InputError("no picture of a known radiance is given");
  const auto check = [&](const CountFrames* frames, const char* what) {
    if (frames != nullptr &&
        (frames->width != pixels.window.width || frames->height != pixels.window.height ||
         frames->mean.size() <= pixels.channel))
      throw InputError(std::string(what) + " must be of one sensor");
  };
  for (const std::vector<SourcePicture>* pictures : {&sources, &whites})
    for (const SourcePicture& picture : *pictures)
      for (const CountFrames* frames : {picture.frames, picture.dark})
        check(frames, "pictures and dark frames");
  const RawCorrections& corrections = pixels.corrections;
  for (const CountFrames* frames :
       {corrections.flat, corrections.flat_dark, corrections.white, corrections.white_dark})
    check(frames, "pictures, flat field and white picture");
  RadiometryFit fit = fit_with(factors_of(pixels, 0), sources, whites, pixels, common);
  if (corrections.flat == nullptr && corrections.white == nullptr) return fit;
  // Flat field and white picture are bent as the other pictures are: what that does to the
  // curvature is small in its second order.
  for (int round = 0; round < 2 && fit.scale.curvature != 0; ++round)
    fit = fit_with(factors_of(pixels, fit.scale.curvature), sources, whites, pixels, common);
  return fit;
}

}  // namespace plenoflame
