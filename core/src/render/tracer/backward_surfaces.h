#pragma once
#include <cstdint>
#include <vector>

#include "plenoflame/sampling/sobol.h"
#include "render/sampling/backward_kernel.h"
#include "render/transport/scatter_walk.h"
#include "render/transport/surface_light.h"
#include "render/transport/world_paths.h"

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
  /// @param light kept by reference
  BackwardSurfacePlan(const SurfaceLightPlan& light, const RenderSettings& settings,
                      std::uint32_t first, const std::vector<SobolPool>& pools);
  const SurfaceLightPlan& light;
  std::uint32_t first = 0;
  /// Further dimensions of the points of the same pools; empty if no random numbers are needed.
  std::vector<SobolPool> pools;
};

/// Finds the light at the ends of a block's paths; one object per worker.
class SurfaceBlock {
 public:
  /// @param walk follows the light in media that scatter; kept by reference; nullptr: nothing
  /// scatters
  SurfaceBlock(const BackwardSurfacePlan& plan, std::size_t channels, ScatterWalk* walk = nullptr);

  void follow(const WorldPaths& paths, const std::vector<RayGroup>& groups,
              MediumCounters& counters);
  /// [W/(m^2 sr)] from the end of ray i, or from the surroundings behind it.
  double radiance(int i, std::size_t channel) const {
    return radiance_[channel][static_cast<std::size_t>(i)];
  }

 private:
  void add_end(const SurfaceHit& hit, const RayGroup& group, int i);
  SurfaceLight::First random_of(const RayGroup& group, int point) const;

  const BackwardSurfacePlan& plan_;
  SurfaceLight light_;
  ScatterWalk* walk_;
  std::vector<std::vector<double>> radiance_;  ///< per channel and ray
  std::vector<SurfacePath> ends_;
  std::vector<SurfaceLight::First> random_;
};

}  // namespace plenoflame
