#pragma once
#include <optional>
#include <vector>

#include "plenoflame/media/medium.h"
#include "plenoflame/render/ray_paths.h"
#include "plenoflame/surfaces/surface_scene.h"

namespace plenoflame {

/// Turns rays into vertices.
class PathTracer {
 public:
  /// @param surfaces on which rays end; may be null
  PathTracer(const Camera& camera, const Medium& medium, const SurfaceScene* surfaces);

  /// Adds the ray from a start on the sensor through its microlens towards an aim.
  void add(Vec2 start, std::optional<LensIndex> lens, Vec2 aim, RayPath& ray,
           RayPaths& paths) const;
  /// Adds the ray from a point in the world, along a unit vector towards the camera; fills in where
  /// it arrives.
  void add_from_scene(const Ray& from, RayPath& ray, RayPaths& paths) const;

 private:
  class Vertices;
  double index_behind(int surface, int type, bool to_scene) const;
  void add_flames(const Ray& ray, double from, double to, bool beside, Vertices& vertices,
                  int samples) const;

  const Camera& camera_;
  const Medium& medium_;
  const SurfaceScene* surfaces_;
  Box box_;
  std::vector<int> steps_;  ///< what paths list from the sensor on, each at most as often as here
  int lens_surfaces_ = 0;
};

/// Radiance per channel of a stretch of a line through the medium, seen from `from`; then its
/// optical thickness. `to` may be infinite.
std::vector<double> carried_by(const Medium& medium, const Ray& ray, double from, double to);

}  // namespace plenoflame
