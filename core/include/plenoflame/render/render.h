#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "plenoflame/base/communicator.h"
#include "plenoflame/base/execution.h"
#include "plenoflame/base/isa.h"
#include "plenoflame/base/part.h"
#include "plenoflame/film/film.h"
#include "plenoflame/image/light_field.h"
#include "plenoflame/render/work_counters.h"
#include "plenoflame/scene/compile.h"

namespace plenoflame {

enum class Precision {
  automatic,  ///< single if it is accurate enough for the scene, otherwise double
  single_precision,
  double_precision,
};

inline constexpr int kForwardSamples = 1000000;  ///< default number of bundles
/// Bundles are independent of each other: more replicates cost memory only.
inline constexpr int kForwardReplicates = 4;
inline constexpr int kMostSamples = 1 << 16;  ///< limit of samples for a target error
inline constexpr int kMostBundles = 1 << 30;  ///< limit of bundles for a target error

/// Settings of a rendering. Values that are 0 take their default.
struct RenderSettings {
  Estimator estimator = Estimator::backward;
  /// Backward: rays per pixel and microlens that covers it, all replicates together. Forward:
  /// energy bundles for the whole image; kForwardSamples is a good start.
  int samples = 64;
  int replicates = 2;  ///< for the standard error
  std::uint64_t seed = 1;
  /// The rendering stops when the relative RMSE over lit pixels is below this at kErrorConfidence
  /// (film.h). With 0 it takes `samples`. With a target, the backward estimator gives more samples
  /// to tiles with larger errors, at most `samples` per pixel.
  double target_error = 0;
  double time_limit = 0;  ///< [s] after which no further round begins; 0: none
  PixelWindow window;     ///< width 0: the whole sensor
  /// The film's tiles that get rays (part_of_tile()). All parts together are the picture, bit by
  /// bit (render/merge.h). Requires a fixed number of samples.
  Part part = {};
  bool skip = true;  ///< false: nothing is left out (for comparison)
  /// Renders costly media with a control variate: radiance from a table, corrected by some of the
  /// rays so that the mean stays unbiased. With false, every ray is integrated.
  bool control_variate = true;
  bool standard_error = true;
  Precision precision = Precision::automatic;
  Isa isa = best_isa();
  /// A film of the same scene and settings to continue from, with the same result as without a
  /// break.
  const Film* resume = nullptr;
  /// Other processes that trace tiles for this one, which is their rank 0 (ranks.h); nullptr: none.
  /// The result does not depend on them. The forward estimator does not use them.
  Communicator* ranks = nullptr;
  /// Called with a consistent film between units of work, after 5 s and then at intervals that
  /// double up to checkpoint_seconds.
  std::function<void(const Film&)> checkpoint;
  double checkpoint_seconds = 60;
};

/// Tells whether every pixel gets a fixed number of samples in one uninterrupted run. This holds
/// for the backward estimator without a target and without a limit. Forward samples belong to the
/// whole image.
bool has_fixed_samples(const RenderSettings& settings);

/// Counts of the completed and the skipped work, and its time.
struct RenderStatistics : WorkCounters {
  double pixels = 0;          ///< pixels of the window
  double lenses = 0;          ///< microlenses whose micro-images meet the window
  double lenses_skipped = 0;  ///< number of these whose beams miss the flame
  /// Parts of the work that neither scene nor settings need, a phrase each.
  std::vector<std::string> left_out;
  double relative_error = -1;        ///< estimated relative RMSE over lit pixels; -1: not estimated
  double relative_error_bound = -1;  ///< upper bound at kErrorConfidence (film.h)
  double flux = 0;                   ///< [W] sum over the image, first channel
  bool complete = true;              ///< false: stopped from outside
  bool target_reached = true;        ///< false: the target error needs more samples or time
  int threads = 0;                   ///< threads of all ranks
  int ranks = 1;                     ///< ranks that shared the tiles
  std::string isa, precision, medium_description;
  std::string surfaces_description;  ///< empty: none
  int wavelengths = 0;               ///< that represent the channels; 0: each channel its own
  double spectral_error = 0;         ///< relative error of that (radiometry/spectral_nodes.h)
  int paths = 1;       ///< paths through the camera: one per colour if glasses disperse
  double seconds = 0;  ///< wall time, without compiling the scene
};

struct RenderResult {
  LightField light_field;
  /// The sums that light_field was made from. They continue the picture: more samples are added to
  /// them.
  Film film;
  RenderStatistics statistics;
};

/// Renders the light field of a scene. The result depends only on scene, settings and instruction
/// set. It does not depend on the number of threads; a pixel does not depend on the window. If
/// execution.stop ends the run, the result so far is returned and marked incomplete.
RenderResult render(const CompiledScene& scene, const RenderSettings& settings,
                    const Execution& execution = {});

}  // namespace plenoflame
