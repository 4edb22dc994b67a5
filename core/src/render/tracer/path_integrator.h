#pragma once
#include <memory>
#include <vector>

#include "render/sampling/aligned_columns.h"
#include "render/tracer/backward_plan.h"
#include "render/tracer/traced_rays.h"
#include "render/transport/medium_segments.h"
#include "render/transport/scatter_walk.h"
#include "render/transport/world_paths.h"

namespace plenoflame {

/// The world line of entry i of a block, with a unit direction.
template <class Real>
Ray line_of(const KernelBlock<Real>& block, int i, Vec3 anchor);

/// Traces a block's rays through the world. Rays that ended in the camera have no path.
template <class Real>
void trace_paths(const TracedRays<Real>& rays, Vec3 anchor, WorldPaths& paths);

/// Finds the radiance that arrives along paths in the world. Along each straight stretch the medium
/// is integrated and scattered light is followed. The light from the end of the path is added. The
/// radiance in air behind a window is the radiance in front of it, times the window's
/// transmittance. One object per worker.
template <class Real>
class PathIntegrator {
 public:
  /// @param plan kept by reference
  explicit PathIntegrator(const BackwardPlan<Real>& plan);

  /// @param radiance of the nodes, at [node * stride + ray]
  /// @param transmittance of the flames in the first channel, by ray
  void integrate(const TracedRays<Real>& rays, Real* radiance, int stride, Real* transmittance,
                 MediumCounters& counters);

  /// The paths of the last integrated block.
  const WorldPaths& paths() const { return paths_; }
  /// [W/(m^2 sr)] that a stretch adds to its ray at the camera, of node n at [n * stretches + s].
  /// The last stretch of a ray includes the light from its end. Only if paths may bend.
  const std::vector<Real>& shares() const { return shares_; }
  /// The flames' transmittance along a stretch, in the first channel. Only if paths may bend.
  double transmittance(std::size_t stretch) const { return segments_.transmittance(stretch); }
  /// Spent on the ends of paths so far.
  double seconds_surfaces() const { return seconds_surfaces_; }

 private:
  void integrate_lines(const TracedRays<Real>& rays, const RadianceBatch<Real>& out,
                       MediumCounters& counters);
  void integrate_stretches(const TracedRays<Real>& rays, const RadianceBatch<Real>& out,
                           MediumCounters& counters);
  template <class Passed>
  void add_scattered(const TracedRays<Real>& rays, const Passed& passed, MediumCounters& counters);

  const BackwardPlan<Real>& plan_;
  std::size_t nodes_;
  std::unique_ptr<ScatterWalk> scatter_;    ///< nullptr: nothing scatters
  std::unique_ptr<SurfaceBlock> surfaces_;  ///< nullptr if the plan has none
  std::size_t passes_;                      ///< number of different transmittances
  AlignedColumns<Real> columns_;
  BasicMediumSegments<Real> segments_;
  WorldPaths paths_;
  std::vector<Real> shares_;
  std::vector<std::vector<double>> scattered_;  ///< by node and stretch
  std::vector<double> passed_;                  ///< by node, along the path so far
  double seconds_surfaces_ = 0;
};

}  // namespace plenoflame
