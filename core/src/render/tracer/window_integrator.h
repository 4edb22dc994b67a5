#pragma once
#include <vector>

#include "render/tracer/backward_plan.h"
#include "render/tracer/traced_rays.h"
#include "render/transport/medium_segments.h"
#include "render/transport/scatter_walk.h"
#include "render/transport/window_ways.h"

namespace plenoflame {

/// The world ray of entry i of a block, from the front of the camera on.
template <class Real>
Ray ray_from_front(const KernelBlock<Real>& block, int i, Vec3 anchor, const CameraFront& front);

/// Traces a block's rays through the scene's windows. Rays that ended in the camera have no path.
template <class Real>
void trace_ways(const TracedRays<Real>& rays, const WindowSet& windows, Vec3 anchor,
                const CameraFront& front, WindowPath& scratch, WindowWays& ways);

/// Finds the radiance that arrives along rays through windows. The path of a ray is a few straight
/// stretches in air. Along each stretch the medium is integrated, surfaces are intersected, and
/// scattered light is followed. The radiance in air behind a window is the radiance in front of it,
/// times the window's transmittance. One object per worker.
template <class Real>
class WindowIntegrator {
 public:
  /// @param plan and surfaces (nullptr: none) and scatter (nullptr: nothing scatters) are kept by
  /// reference
  WindowIntegrator(const BackwardPlan<Real>& plan, SurfaceBlock<Real>* surfaces,
                   ScatterWalk* scatter);

  /// @param radiance of the nodes, at [node * stride + ray]
  /// @param transmittance of the flames in the first channel, by ray
  void integrate(const TracedRays<Real>& rays, Real* radiance, int stride, Real* transmittance,
                 MediumCounters& counters);

  /// The paths of the last integrated block.
  const WindowWays& ways() const { return ways_; }
  /// [W/(m^2 sr)] that a stretch adds to its ray at the camera, of node n at [n * stretches + s].
  /// The last stretch of a ray includes the light from its end.
  const std::vector<Real>& shares() const { return shares_; }
  /// The flames' transmittance along a stretch, in the first channel.
  double transmittance(std::size_t stretch) const { return segments_.transmittance(stretch); }
  double seconds_surfaces() const { return seconds_surfaces_; }

 private:
  void add_scattered(const TracedRays<Real>& rays, MediumCounters& counters);

  const BackwardPlan<Real>& plan_;
  CameraFront front_;
  SurfaceBlock<Real>* surfaces_;
  ScatterWalk* scatter_;
  std::size_t nodes_;
  BasicMediumSegments<Real> segments_;
  WindowPath path_;
  WindowWays ways_;
  std::vector<Real> shares_;
  std::vector<std::vector<double>> scattered_;  ///< by node and stretch
  std::vector<double> passed_;                  ///< by node, along the path so far
  double seconds_surfaces_ = 0;
};

}  // namespace plenoflame
