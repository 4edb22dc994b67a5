#pragma once
#include <optional>
#include <span>
#include <vector>

#include "plenoflame/media/medium.h"
#include "plenoflame/render/ray_paths.h"
#include "plenoflame/scene/compile.h"
#include "render/transport/camera_aim.h"
#include "render/transport/world_paths.h"

namespace plenoflame {

/// Converts rays to vertices.
class PathTracer {
 public:
  /// @param scene kept by reference
  PathTracer(const CompiledScene& scene, const Medium& medium);

  /// Adds the ray from a start on the sensor through its microlens towards an aim.
  /// @return the ray in the world as it leaves the camera; none: it ends in the camera
  std::optional<Ray> add(Vec2 start, std::optional<LensIndex> lens, Vec2 aim, RayPath& ray,
                         RayPaths& paths) const;
  /// Adds the ray from a point in the world along a unit vector towards the camera, and fills in
  /// where it arrives.
  void add_from_scene(const Ray& from, RayPath& ray, RayPaths& paths) const;

 private:
  class Vertices;
  double index_behind(int surface, int type, bool to_scene) const;
  void add_flames(const Ray& ray, double from, double to, bool beside, Vertices& vertices,
                  int samples) const;

  void add_stretches(std::span<const AirSegment> segments, bool beside, int samples,
                     Vertices& vertices) const;

  const Camera& camera_;
  const Medium& medium_;
  const SurfaceScene* surfaces_;
  Box box_;
  std::vector<int> steps_;  ///< steps of a complete path, from the sensor on
  int lens_surfaces_ = 0;
  const WindowSet* windows_;
  WorldPaths empty_;  ///< without paths
  CameraAim aim_;
};

}  // namespace plenoflame
