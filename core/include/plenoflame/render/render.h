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
  automatic,  ///< single where it is accurate enough for the scene, otherwise double
  single_precision,
  double_precision,
};

inline constexpr int kForwardSamples = 1000000;  ///< bundles, where nobody says otherwise
/// Bundles are independent one by one: more replicates cost memory only.
inline constexpr int kForwardReplicates = 4;
inline constexpr int kMostSamples = 1 << 16;  ///< at which a target error is given up
inline constexpr int kMostBundles = 1 << 30;  ///< the same, of bundles

struct CompiledCamera;

/// Settings of a rendering. Figures that are 0 take their default.
struct RenderSettings {
  Estimator estimator = Estimator::backward;
  /// Backward: rays per pixel and microlens that covers it, all replicates together. Forward:
  /// energy bundles in total, for the whole image; kForwardSamples are a start.
  int samples = 64;
  int replicates = 2;  ///< independent randomisations, for the standard error
  std::uint64_t seed = 1;
  /// Stop when the relative RMSE over lit pixels is below this at kErrorConfidence (film.h); 0:
  /// `samples` are taken. Backward: samples then go where the error is, tile by tile, at most
  /// `samples` per pixel.
  double target_error = 0;
  double time_limit = 0;  ///< [s] after which no further round is begun; 0: none
  PixelWindow window;     ///< width 0: the whole sensor
  /// The film's tiles that get rays (part_of_tile()): all parts together are the picture, bit
  /// by bit (render/merge.h). For a fixed number of samples only.
  Part part = {};
  bool skip = true;  ///< false: nothing is left out (for comparison)
  /// Radiance of costly media from a table, corrected by some of the rays so that the mean stays
  /// unbiased; false: every ray is integrated.
  bool control_variate = true;
  bool standard_error = true;
  /// false: of a fixed number of samples, tiles that have theirs are finished (Film::finish()) as
  /// they come, which takes less memory; true: their sums are kept instead.
  bool keep_sums = false;
  Precision precision = Precision::automatic;
  Isa isa = best_isa();
  /// The rays that were found before (compiled_camera.h), which render() takes in place of new
  /// ones: samples, replicates, seed, target and limit are then its own. nullptr: none.
  std::shared_ptr<const CompiledCamera> compiled;
  std::string compiled_name = "the compiled camera";  ///< for messages
  /// A film of the same scene and settings to go on from, as if there had been no break. One with
  /// finished tiles (see keep_sums) is for a fixed number of samples only, and not to be complete.
  const Film* resume = nullptr;
  /// Other processes that trace tiles for this one, which is their rank 0 (ranks.h); nullptr: none.
  /// The result does not depend on them. The forward estimator does without.
  Communicator* ranks = nullptr;
  /// Called between units of work, after 5 s and then at intervals that double up to
  /// checkpoint_seconds, with a consistent film.
  std::function<void(const Film&)> checkpoint;
  double checkpoint_seconds = 60;
};

/// Tells whether every pixel gets a number of samples that is fixed, at one go: backward only, as
/// forward samples are those of the whole image, and with neither a target nor a limit.
bool has_fixed_samples(const RenderSettings& settings);

/// Counts of the work done and left out, and the time it took.
struct RenderStatistics : WorkCounters {
  double pixels = 0;          ///< in the window
  double lenses = 0;          ///< microlenses whose micro-images meet the window
  double lenses_skipped = 0;  ///< of these, whose beams miss the flame
  /// Parts of the work that neither scene nor settings ask for, a phrase each.
  std::vector<std::string> left_out;
  double relative_error = -1;        ///< estimated relative RMSE over lit pixels; -1: not estimated
  double relative_error_bound = -1;  ///< below which it is at kErrorConfidence (film.h)
  double flux = 0;                   ///< [W] sum over the image, first channel
  bool complete = true;              ///< false: stopped from outside
  bool target_reached = true;        ///< false: the target error needs more samples or time
  int threads = 0;                   ///< of all ranks
  int ranks = 1;                     ///< that shared the tiles
  std::string isa, precision, medium_description;
  std::string surfaces_description;  ///< empty: none
  int wavelengths = 0;               ///< that stand for the channels; 0: each for itself
  double spectral_error = 0;         ///< of that, relative (radiometry/spectral_nodes.h)
  int paths = 1;                     ///< through the camera, one for each colour that it disperses
  double seconds = 0;                ///< by the clock, without compiling the scene
};

struct RenderResult {
  LightField light_field;
  /// The sums that light_field was made from, to continue it; if all is done, without those of
  /// finished tiles.
  Film film;
  RenderStatistics statistics;
};

/// Renders the light field of a scene. The result depends on scene, settings and instruction set
/// only: not on the number of threads, nor on the window for the pixels inside it.
/// Stopped through execution.stop it returns what is there, marked incomplete.
RenderResult render(const CompiledScene& scene, const RenderSettings& settings,
                    const Execution& execution = {});

}  // namespace plenoflame
