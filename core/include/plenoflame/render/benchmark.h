#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/image/light_field.h"
#include "plenoflame/render/render.h"
#include "plenoflame/scene/compile.h"

/// Error against run time, as `plenoflame bench` measures it.
namespace plenoflame {

/// A converged light field of a scene, with standard errors.
struct BenchmarkReference {
  LightField light_field;
  double relative_error = 0;  ///< relative RMSE over lit pixels, from its standard errors
  double seconds = 0;         ///< time of the computation; 0: it comes from the cache
  bool cached = false;
  std::string file;  ///< path in the cache; empty: it is not kept
};

struct ReferenceSettings {
  PixelWindow window;      ///< width 0: the whole sensor
  int samples = 1024;      ///< rays per pixel and microlens (backward estimator)
  std::uint64_t seed = 1;  ///< of the measured runs; the reference uses another seed
  std::string cache;       ///< folder, created if it is missing; empty: the reference is not kept
};

/// Takes the reference from the cache, or renders it and keeps it there. The file name depends on
/// the scene text, the flame files (size and time of change) and the window. The version, the
/// number of samples and a checksum are stored in the file and compared. If they differ, the
/// reference is rendered again and a note gives the reason. A cache that cannot be written causes a
/// warning.
/// @throws InputError when no pixel is lit, Cancelled when stopped
BenchmarkReference benchmark_reference(const CompiledScene& scene,
                                       const ReferenceSettings& settings,
                                       const Execution& execution);

/// One number of samples of one estimator, measured `seconds.size()` times with different seeds.
/// Errors refer to the first channel, over pixels above kLitShare of the reference's maximum.
struct BenchmarkPoint {
  Estimator estimator = Estimator::backward;
  double samples = 0;  ///< as LightField::samples
  /// sqrt(mean((a - b)^2) - mean(s_b^2)) / mean(b), with the reference's standard error s_b. It is
  /// 0 when s_b hides the error.
  double relative_rmse = 0;
  double relative_bias = 0;        ///< mean(a - b) / mean(b)
  double relative_bias_error = 0;  ///< standard error of the bias, with that of the reference
  std::vector<double> seconds;     ///< wall time of each run
  double rays = 0;                 ///< of one run
  double peak_memory = 0;          ///< [byte]; filled in by a caller that can measure it

  double median_seconds() const;
  double rays_per_second() const { return rays / median_seconds(); }
  /// 1 / (error^2 time) [1/s]. For plain Monte Carlo it does not depend on the number of samples.
  double efficiency() const;
};

/// Renders the reference's window `repeat` times with the seeds settings.seed, settings.seed + 1,
/// ..., and compares the pictures with the reference. @throws Cancelled when stopped
BenchmarkPoint benchmark_point(const CompiledScene& scene, RenderSettings settings, int repeat,
                               const BenchmarkReference& reference, const Execution& execution);

/// Exponent of the error as a power of the number of samples. It is fitted by least squares to the
/// points of one estimator with an error above 0. NaN with fewer than two such points.
double fitted_slope(const std::vector<BenchmarkPoint>& points, Estimator estimator);

}  // namespace plenoflame
