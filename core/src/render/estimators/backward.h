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
  /// Replaces a medium that only windows separate from the camera. nullptr: there is no such
  /// medium, or its windows are not supported.
  std::unique_ptr<const MediumBehindWindows> behind_windows;
  PathLight light;
  bool takes_lines = false;  ///< BackwardPlan::takes_lines
  /// Replaces the medium where it is smooth (single precision only); may be nullptr.
  std::unique_ptr<RadianceTable> table;
};

/// The shared data of all spectral paths of a scene (CompiledScene::paths()).
struct BackwardShared {
  BackwardShared(const CompiledScene& scene, const RenderSettings& settings,
                 const Execution& execution);
  std::vector<PathShared> paths;
};

/// A tile of the film that receives the points of a range.
struct TileJob {
  int tile = 0;
  std::size_t range = 0;  ///< index among the ranges of the pass
};

/// Called after each tile, from one thread at a time. @param rays traced for it
using TileDone = std::function<void(const TileJob& job, double rays)>;

/// Gives a thread its next tile; none: all are done. Called from several threads.
using NextTile = std::function<std::optional<TileJob>()>;

/// A pass of the estimator. The constructor computes the data that all tiles share. Keeps
/// references to scene and settings.
class BackwardPass {
 public:
  /// @param ranges of points; each tile gets one of them
  /// @param shared kept by reference @param threads for the work of the constructor
  BackwardPass(const CompiledScene& scene, const RenderSettings& settings,
               const std::vector<PointRange>& ranges, const BackwardShared& shared,
               int threads = 1);
  ~BackwardPass();
  BackwardPass(const BackwardPass&) = delete;
  BackwardPass& operator=(const BackwardPass&) = delete;

  /// Adds the points to `film`, for the pixels of the tiles. Each tile may occur once (else
  /// std::logic_error). All threads share the jobs in their order. Jobs of the same range should be
  /// consecutive. Statistics are added up. The function does not report to execution.progress,
  /// since only the caller knows the jobs' share of a run.
  /// @return false when it was stopped; the other tiles then keep their number of samples
  bool run(const std::vector<TileJob>& jobs, const Execution& execution, Film& film,
           RenderStatistics& statistics, const TileDone& tile_done = {}) const;
  /// The same for any number of jobs that arrive one by one. A tile may not occur again while it is
  /// in work.
  void run(const NextTile& next, const Execution& execution, Film& film,
           RenderStatistics& statistics, const TileDone& tile_done) const;

 private:
  template <class Real>
  using Plans = std::vector<std::vector<std::unique_ptr<const BackwardPlan<Real>>>>;
  template <class Real>
  void make_plans(const CompiledScene& scene, const RenderSettings& settings,
                  const std::vector<PointRange>& ranges, const BackwardShared& shared, int threads,
                  Plans<Real>& plans);
  std::vector<std::unique_ptr<const SceneMedium>> media_;  // one for each path
  bool is_single_;
  Plans<float> single_;  // of each range, for each path; the other precision is empty
  Plans<double> double_;
};

/// Counts the microlenses that may light the window, and those that are skipped because their beams
/// miss the flame, into the statistics.
void count_lenses(const CompiledScene& scene, const BackwardShared& shared,
                  const PixelWindow& window, RenderStatistics& statistics);

}  // namespace plenoflame
