#pragma once
#include <optional>
#include <span>
#include <vector>

#include "plenoflame/media/medium.h"
#include "plenoflame/render/ray_paths.h"
#include "plenoflame/scene/compile.h"
#include "render/transport/window_aim.h"
#include "render/transport/window_ways.h"
#include "render/visibility/camera_front.h"

namespace plenoflame {

/// Converts rays to vertices.
class PathTracer {
 public:
  /// @param scene its camera, surfaces and windows are kept by reference
  PathTracer(const CompiledScene& scene, const Medium& medium);

  /// Adds the ray from a start on the sensor through its microlens towards an aim.
  void add(Vec2 start, std::optional<LensIndex> lens, Vec2 aim, RayPath& ray,
           RayPaths& paths) const;
  /// Adds the ray from a point in the world along a unit vector towards the camera, and fills in
  /// where it arrives.
  void add_from_scene(const Ray& from, RayPath& ray, RayPaths& paths) const;

 private:
  class Vertices;
  double index_behind(int surface, int type, bool to_scene) const;
  void add_flames(const Ray& ray, double from, double to, bool beside, Vertices& vertices,
                  int samples) const;

  void add_to_scene(const Ray& exit, RayPath& ray, RayPaths& paths, Vertices& vertices) const;
  void add_stretches(const std::vector<AirSegment>& segments, bool beside, int samples,
                     Vertices& vertices) const;

  const Camera& camera_;
  const Medium& medium_;
  const SurfaceScene* surfaces_;
  Box box_;
  std::vector<int> steps_;  ///< steps of a complete path, from the sensor on
  int lens_surfaces_ = 0;
  const WindowSet* windows_;
  CameraFront front_;
  std::optional<WindowAim> aim_;  ///< only with windows
};

/// Radiance per channel of a stretch of a line through the medium, seen from `from`, followed by
/// its optical thickness. `to` may be infinite.
std::vector<double> carried_by(const Medium& medium, const Ray& ray, double from, double to);

/// The light that a path through windows carries, seen from its first point.
struct CarriedLight {
  std::vector<double> radiance;             ///< of the medium, at each node
  std::vector<std::vector<double>> passed;  ///< transmittance of the medium up to a stretch
};
CarriedLight carried_through_windows(const Medium& medium, std::span<const AirSegment> stretches);

}  // namespace plenoflame
