#pragma once
#include <cstddef>
#include <vector>

#include "plenoflame/optics/window_set.h"
#include "plenoflame/solids/surface_scene.h"

namespace plenoflame {

/// The paths of a block's rays through windows, from the front of the camera on.
struct WindowWays {
  struct Way {
    std::size_t first = 0, count = 0;  ///< in `segments`; none: the ray ended in the camera
    bool open = false;                 ///< infinite after the last stretch
  };
  std::vector<AirSegment> segments;
  std::vector<Way> ways;  ///< by ray

  void clear(std::size_t rays) {
    segments.clear();
    ways.assign(rays, {});
  }
  /// Adds the path of a ray. @param path temporary storage
  void add(std::size_t ray, const WindowSet& windows, const Ray& from, WindowPath& path) {
    windows.trace(from, path);
    ways[ray] = {segments.size(), path.segments.size(), !path.stopped};
    segments.insert(segments.end(), path.segments.begin(), path.segments.end());
  }
};

/// Cuts a path off at the first solid surface. @return the stretch that ends there; nullptr: none
inline const AirSegment* cut_at_surface(const SurfaceScene& surfaces, WindowWays& ways,
                                        WindowWays::Way& way, SurfaceHit& hit) {
  for (std::size_t k = 0; k < way.count; ++k) {
    AirSegment& segment = ways.segments[way.first + k];
    if (!surfaces.intersect(segment.ray, 0, segment.far, {}, hit)) continue;
    segment.far = hit.t;
    segment.window = -1;
    way.count = k + 1;
    way.open = false;
    return &segment;
  }
  return nullptr;
}

}  // namespace plenoflame
