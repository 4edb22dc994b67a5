#pragma once
#include <memory>
#include <vector>

#include "plenoflame/film/film.h"
#include "plenoflame/render/render.h"
#include "render/point_range.h"
#include "render/radiance_table.h"
#include "render/scatter_walk.h"
#include "render/scene_beams.h"
#include "render/scene_medium.h"
#include "render/surface_light.h"

namespace plenoflame {

template <class Real>
struct BackwardPlan;

/// What all passes of a rendering share.
struct BackwardShared {
  BackwardShared(const CompiledScene& scene, const RenderSettings& settings,
                 const Execution& execution);
  std::unique_ptr<const SceneBeams> beams;  ///< nullptr: nothing is skipped
  /// Stands in for the medium where it is smooth (single precision only); may be nullptr.
  std::unique_ptr<RadianceTable> table;
  std::unique_ptr<const SurfaceLightPlan> light;  ///< nullptr: no surfaces, no surroundings
  std::unique_ptr<const ScatterPlan> scatter;     ///< nullptr: nothing scatters
  std::vector<BackwardShared> parts;              ///< of a scene that has parts: theirs
};

/// A tile of the film, to which the points of a range are added.
struct TileJob {
  int tile = 0;
  std::size_t range = 0;  ///< which of the pass' ranges
};

/// What is the same for all tiles is made once, in the constructor. Keeps references to scene and
/// settings.
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
  /// one another. Statistics are added up.
  /// @return false when it was stopped; tiles that were not reached keep their number of samples.
  bool run(const std::vector<TileJob>& jobs, const Execution& execution, Film& film,
           RenderStatistics& statistics) const;

 private:
  template <class Real>
  using Plans = std::vector<std::unique_ptr<const BackwardPlan<Real>>>;
  template <class Real>
  void make_plans(const CompiledScene& scene, const RenderSettings& settings,
                  const BackwardShared& shared, int threads, Plans<Real>& plans);
  std::vector<std::unique_ptr<const SceneMedium>> media_;  // one for each part of the scene
  std::vector<PointRange> ranges_;
  bool is_single_;
  Plans<float> single_;  // of each range, for each part; the others are empty
  Plans<double> double_;
};

/// Counts the microlenses that may light the window, and those of them that are left out because
/// their beams miss the flame, into the statistics.
void count_lenses(const CompiledScene& scene, const BackwardShared& shared,
                  const PixelWindow& window, RenderStatistics& statistics);

/// Whether single precision is accurate enough: rounding of a ray over the distance to the medium
/// must stay well below the medium's features.
bool single_precision_suffices(const CompiledScene& scene);

}  // namespace plenoflame
