#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/image/light_field.h"
#include "plenoflame/render/render.h"
#include "plenoflame/scene/compile.h"

/// Error against run time: what `plenoflame bench` measures.
namespace plenoflame {

/// A converged light field of a scene, with standard errors.
struct BenchmarkReference {
  LightField light_field;
  double relative_error = 0;  ///< its own relative RMSE over lit pixels, by its standard errors
  double seconds = 0;         ///< that computing it took; 0: taken from the cache
  bool cached = false;
  std::string file;  ///< where it is kept; empty: nowhere
};

struct ReferenceSettings {
  PixelWindow window;      ///< width 0: the whole sensor
  int samples = 1024;      ///< rays per pixel and microlens (backward estimator)
  std::uint64_t seed = 1;  ///< of the runs that are measured; the reference takes another one
  std::string cache;       ///< folder, made when missing; empty: the reference is not kept
};

/// Takes the reference from the cache, or renders it and keeps it there. The file's name is made
/// from scene text, flame files (size and time of change) and window; inside, version, number of
/// samples and a checksum are compared. What does not fit is computed again, with a note that says
/// why. A cache that cannot be written is a warning.
/// @throws InputError when no pixel is lit, Cancelled when stopped
BenchmarkReference benchmark_reference(const CompiledScene& scene,
                                       const ReferenceSettings& settings,
                                       const Execution& execution);

/// One number of samples of one estimator, measured `seconds.size()` times with different seeds.
/// Errors are of the first channel, over pixels above kLitShare of the reference's largest.
struct BenchmarkPoint {
  Estimator estimator = Estimator::backward;
  double samples = 0;              ///< as LightField::samples
  double relative_rmse = 0;        ///< sqrt(mean((a - b)^2) - mean(s_b^2)) / mean(b), s_b: the
                                   ///< reference's own standard error; 0 when that hides it
  double relative_bias = 0;        ///< mean(a - b) / mean(b)
  double relative_bias_error = 0;  ///< its standard error, the reference's included
  std::vector<double> seconds;     ///< wall time of each run
  double rays = 0;                 ///< of one run
  double peak_memory = 0;          ///< [byte]; filled in by whoever can measure it

  double median_seconds() const;
  double rays_per_second() const { return rays / median_seconds(); }
  /// 1 / (error^2 time) [1/s]: independent of the number of samples for plain Monte Carlo.
  double efficiency() const;
};

/// Renders `repeat` times, seeds settings.seed, seed + 1, ..., and compares with the reference,
/// whose window is used. @throws Cancelled when stopped
BenchmarkPoint benchmark_point(const CompiledScene& scene, RenderSettings settings, int repeat,
                               const BenchmarkReference& reference, const Execution& execution);

/// Exponent of the error as a power of the number of samples, by least squares over the points of
/// one estimator with an error above 0; NaN with fewer than two.
double fitted_slope(const std::vector<BenchmarkPoint>& points, Estimator estimator);

}  // namespace plenoflame
