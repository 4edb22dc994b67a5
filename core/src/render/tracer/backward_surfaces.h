#pragma once
#include <cstdint>
#include <vector>

#include "plenoflame/sampling/sobol.h"
#include "render/sampling/backward_kernel.h"
#include "render/transport/scatter_walk.h"
#include "render/transport/surface_light.h"
#include "render/transport/window_ways.h"
#include "render/visibility/camera_front.h"

namespace plenoflame {

/// Rays of a block that belong to one pixel and microlens.
struct RayGroup {
  int first = 0, count = 0;  ///< position in the block
  int offset = 0;            ///< number of the first ray among all replicates' points
  int level = 0, entry = 0;  ///< pool and its entry
  std::uint64_t key = 0;     ///< of pixel, microlens and seed
};

/// The plan of surfaces in the backward estimator; the same for all tiles.
struct BackwardSurfacePlan {
  /// @param anchor world point to which the rays' positions are relative
  /// @param light kept by reference
  BackwardSurfacePlan(const SurfaceLightPlan& light, const RenderSettings& settings,
                      std::uint32_t first, const std::vector<SobolPool>& pools, Vec3 anchor);
  const SurfaceLightPlan& light;
  std::uint32_t first = 0;
  Vec3 anchor;
  CameraFront front;
  /// Further dimensions of the points of the same pools; empty if no random numbers are needed.
  std::vector<SobolPool> pools;
};

/// Intersects the rays of a block with the surfaces; one object per worker.
template <class Real>
class SurfaceBlock {
 public:
  /// @param walk follows the light in media that scatter; kept by reference; nullptr: nothing
  /// scatters
  SurfaceBlock(const BackwardSurfacePlan& plan, int channels, ScatterWalk* walk = nullptr);

  /// Finds where the rays end, and the radiance from there.
  /// @param padded number of rays with their padding, whose t_far is set
  void trace(const KernelBlock<Real>& block, const std::vector<RayGroup>& groups, int padded,
             MediumCounters& counters);
  /// The same for rays through windows. Their paths are cut off at their ends.
  void trace_ways(WindowWays& ways, const std::vector<RayGroup>& groups, MediumCounters& counters);
  /// [W/(m^2 sr)] from the end of ray i, or from the surroundings behind it.
  double radiance(int i, std::size_t channel) const {
    return radiance_[channel][static_cast<std::size_t>(i)];
  }
  /// The distance at which each ray ends, in the precision of the block [m]; aligned to 64 bytes.
  const Real* t_far() const { return t_far_; }
  /// [m] distance of the end of ray i.
  double end(int i) const { return ends_[static_cast<std::size_t>(i)]; }
  /// Adds transmittance * radiance of the surfaces to `radiance`, channel c at c * stride.
  void add(const Real* transmittance, int transmittance_stride, Real* radiance, int stride) const;
  double rays() const { return light_.rays(); }

 private:
  void trace_ray(const KernelBlock<Real>& block, const RayGroup& group, int i);
  void add_path(SurfacePath path, const RayGroup& group, int i);
  void add_surroundings(int i);
  void clear();
  void follow(MediumCounters& counters);
  SurfaceLight::First random_of(const RayGroup& group, int point) const;

  const BackwardSurfacePlan& plan_;
  const SurfaceScene* surfaces_;
  SurfaceLight light_;
  ScatterWalk* walk_;
  int count_ = 0;
  std::vector<Real> storage_;
  Real* t_far_ = nullptr;
  std::vector<double> ends_;
  std::vector<std::vector<double>> radiance_;  ///< per channel and ray
  std::vector<SurfacePath> paths_;
  std::vector<SurfaceLight::First> random_;
};

}  // namespace plenoflame
