#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "plenoflame/film/film.h"
#include "plenoflame/render/render.h"
#include "render/sampling/point_range.h"
#include "render/tracer/radiance_table.h"
#include "render/transport/medium_behind_windows.h"
#include "render/transport/scatter_walk.h"
#include "render/transport/scene_medium.h"
#include "render/transport/surface_light.h"
#include "render/visibility/scene_beams.h"

namespace plenoflame {

template <class Real>
struct BackwardPlan;

/// Data of one spectral path that all passes of a rendering share.
struct PathShared {
  std::unique_ptr<const SceneBeams> beams;  ///< nullptr: nothing is skipped
  /// Stands in for a medium that only windows separate from the camera; nullptr: they do not, or in
  /// ways that it does not know.
  std::unique_ptr<const MediumBehindWindows> behind_windows;
  /// Stands in for the medium where it is smooth (single precision only); may be nullptr.
  std::unique_ptr<RadianceTable> table;
  std::unique_ptr<const SurfaceLightPlan> light;  ///< nullptr: no surfaces, no surroundings
  std::unique_ptr<const ScatterPlan> scatter;     ///< nullptr: nothing scatters
};

/// The same of all spectral paths of a scene (CompiledScene::paths()).
struct BackwardShared {
  BackwardShared(const CompiledScene& scene, const RenderSettings& settings,
                 const Execution& execution);
  std::vector<PathShared> paths;
};

/// A tile of the film, to which the points of a range are added.
struct TileJob {
  int tile = 0;
  std::size_t range = 0;  ///< which of the pass' ranges
};

/// Called after each tile, from one thread at a time. @param rays that were sent for it
using TileDone = std::function<void(const TileJob& job, double rays)>;

/// Gives a thread its next tile; none: there is no more. Called from several threads.
using NextTile = std::function<std::optional<TileJob>()>;

/// Adds tiles to a film, from all threads of an execution, until there are no more; adds up
/// statistics.
using TileWork = std::function<void(const NextTile& next, const Execution& execution, Film& film,
                                    RenderStatistics& statistics, const TileDone& tile_done)>;

/// A pass makes what is the same for all tiles once, in the constructor. Keeps references to scene
/// and settings.
class BackwardPass {
 public:
  /// @param ranges of points that its tiles get, each its own
  /// @param shared kept, must live as long @param threads for what is made here
  BackwardPass(const CompiledScene& scene, const RenderSettings& settings,
               std::vector<PointRange> ranges, const BackwardShared& shared, int threads = 1);
  ~BackwardPass();
  BackwardPass(const BackwardPass&) = delete;
  BackwardPass& operator=(const BackwardPass&) = delete;

  /// Adds the points to `film`, for the pixels of the tiles, each of which may come once (else
  /// std::logic_error). All threads share all jobs, in their order: those of a range best follow
  /// one another. Statistics are added up. execution.progress is left alone: what share of a run
  /// the jobs are, the caller knows.
  /// @return false when it was stopped; tiles that were not reached keep their number of samples.
  bool run(const std::vector<TileJob>& jobs, const Execution& execution, Film& film,
           RenderStatistics& statistics, const TileDone& tile_done = {}) const;
  /// The same for jobs that come one by one, in any number; none may come while it is worked on.
  void run(const NextTile& next, const Execution& execution, Film& film,
           RenderStatistics& statistics, const TileDone& tile_done) const;
  /// The latter as a function, for as long as the pass lives.
  TileWork work() const;

 private:
  template <class Real>
  using Plans = std::vector<std::unique_ptr<const BackwardPlan<Real>>>;
  template <class Real>
  void make_plans(const CompiledScene& scene, const RenderSettings& settings,
                  const BackwardShared& shared, int threads, Plans<Real>& plans);
  std::vector<std::unique_ptr<const SceneMedium>> media_;  // one for each path
  std::vector<PointRange> ranges_;
  bool is_single_;
  Plans<float> single_;  // of each range, for each path; the others are empty
  Plans<double> double_;
};

/// Counts the microlenses that may light the window, and those of them that are left out because
/// their beams miss the flame, into the statistics.
void count_lenses(const CompiledScene& scene, const BackwardShared& shared,
                  const PixelWindow& window, RenderStatistics& statistics);

/// Tells whether single precision is accurate enough: rounding of a ray over the distance to the
/// medium must stay well below the medium's features.
bool single_precision_suffices(const CompiledScene& scene);

}  // namespace plenoflame
