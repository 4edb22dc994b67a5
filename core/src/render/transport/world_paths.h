#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "plenoflame/scene/compile.h"
#include "plenoflame/solids/surface_scene.h"
#include "render/visibility/camera_front.h"

namespace plenoflame {

/// The path of a ray in the world, from the front of the camera to a solid surface or out of the
/// scene. It has one straight stretch in air, or several with windows between them.
struct WorldPath {
  std::size_t first = 0, count = 0;  ///< of its stretches; none: the ray ended in the camera
  int hit = -1;                      ///< number of the surface hit at its end; -1: none
  bool open = false;                 ///< infinite after the last stretch
};

/// The paths of some rays of a camera; the object may be used again and again.
class WorldPaths {
 public:
  /// @param scene kept by reference
  explicit WorldPaths(const CompiledScene& scene);

  void clear(std::size_t rays);
  /// Adds the path of a ray. @param line on which it leaves the camera, with a unit direction
  void add(std::size_t ray, const Ray& line);
  /// Adds the path of one ray alone.
  const WorldPath& trace(const Ray& line);

  /// False: every path has one stretch.
  bool may_bend() const { return windows_ != nullptr; }
  std::size_t size() const { return paths_.size(); }
  const WorldPath& operator[](std::size_t ray) const { return paths_[ray]; }
  std::span<const AirSegment> stretches() const { return stretches_; }
  std::span<const AirSegment> stretches(const WorldPath& path) const {
    return stretches().subspan(path.first, path.count);
  }
  /// The hit at the end of a path that has one; its `t` counts along the last stretch.
  const SurfaceHit& hit(const WorldPath& path) const {
    return hits_[static_cast<std::size_t>(path.hit)];
  }
  /// The place in glass at which nothing comes from beyond; of the last path, if it is not open and
  /// has no hit.
  Vec3 stop() const { return way_.stop; }

 private:
  const WindowSet* windows_;
  const SurfaceScene* surfaces_;
  CameraFront front_;
  WindowPath way_;
  SurfaceHit hit_;
  std::vector<WorldPath> paths_;
  std::vector<AirSegment> stretches_;
  std::vector<SurfaceHit> hits_;
};

/// Follows light from a point of the scene, through its windows if there are any.
void trace_from(const CompiledScene& scene, const Ray& ray, WindowPath& path);

}  // namespace plenoflame
