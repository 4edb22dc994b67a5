#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "plenoflame/render/ray_paths.h"

namespace plenoflame {

/// Bundles of rays to trace together, and which of their rays to keep.
struct RayPathRequest {
  std::vector<Pixel> pixels;           ///< all rays of each
  std::vector<LensIndex> microlenses;  ///< all rays through each
  std::vector<Vec3> points;            ///< [m] world; rays from there towards the camera
  int random_pixels = 0;               ///< number of further pixels, chosen at random
  bool chief_rays = false;             ///< the chief ray of every microlens
  int rays_per_pixel = 64;             ///< and per microlens
  int rays_per_point = 64;
  int flame_samples = 0;              ///< RayPaths::flame_samples
  std::optional<std::uint64_t> seed;  ///< none: the scene's
  /// The rays to keep, by RayStatus.
  std::array<bool, 4> statuses{true, true, true, true};
  int type = -1;         ///< of the microlens; negative: any
  std::size_t most = 0;  ///< RaySelection::most
};

/// @throws as add_pixel_rays(), add_microlens_rays(), add_object_rays(), add_chief_rays(),
/// random_pixels()
RayPaths trace_ray_paths(const CompiledScene& scene, const RayPathRequest& request,
                         const Execution& execution);

}  // namespace plenoflame
