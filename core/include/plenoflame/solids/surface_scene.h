#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/math/vector.h"
#include "plenoflame/radiometry/source_function.h"
#include "plenoflame/scene/solid_spec.h"

namespace plenoflame {

/// A place on a surface, by number: where a ray starts, so that it does not meet that place again.
struct SurfacePart {
  int surface = -1;  ///< of the scene's list; -1: in free space
  int part = 0;      ///< face of a body or triangle of a mesh
  friend bool operator==(const SurfacePart&, const SurfacePart&) = default;
};

/// The place where a ray meets a surface.
struct SurfaceHit {
  double t = 0;  ///< [m] along the ray
  SurfacePart where;
  Vec3 point;               ///< [m] world
  Vec3 normal;              ///< unit, towards the side that the ray came from
  bool front = true;        ///< whether that is the front (outside) of the surface
  double reflectivity = 0;  ///< of that side, at this point
};

/// A point of a surface, drawn evenly over its area.
struct SurfacePoint {
  Vec3 point;   ///< [m] world
  Vec3 normal;  ///< unit, towards the front
  SurfacePart where;
};

/// A point of a calibration pattern: a corner of a checkerboard, the centre of a dot.
struct PatternPoint {
  int surface = 0;  ///< of the scene's list
  int column = 0, row = 0;
  Vec3 point;  ///< [m] world
};

/// The solid surfaces of a scene, compiled and immutable; safe to use from many threads. Analytic
/// shapes are intersected exactly, in double precision; triangles are found by Embree and the hit
/// computed again in double precision.
class SurfaceScene {
 public:
  virtual ~SurfaceScene() = default;

  /// The first surface that a ray meets at t_near < t < t_far. The place where the ray starts is
  /// not met again, even if its origin is rounded.
  virtual bool intersect(const Ray& ray, double t_near, double t_far, SurfacePart from,
                         SurfaceHit& hit) const = 0;
  /// Tells whether there is any.
  virtual bool occluded(const Ray& ray, double t_near, double t_far, SurfacePart from) const = 0;

  virtual int surface_count() const = 0;
  /// Radiance that a side of a surface emits [W/(m^2 sr)] per channel; nullptr: it is dark.
  virtual const double* emission(int surface, bool front) const = 0;
  /// Area [m^2], infinite for a plane without end.
  virtual double area(int surface) const = 0;
  /// @param choice, u, v uniform in (0, 1); the area must be finite
  virtual SurfacePoint point_on(int surface, double choice, double u, double v) const = 0;

  /// World box around all surfaces that have an end; empty when there are none.
  virtual Box bounds() const = 0;
  virtual bool has_endless_plane() const = 0;
  /// Smallest length over which the surfaces vary (a side, a cell of a pattern) [m].
  virtual double feature_size() const = 0;
  /// The surface that a point is inside of (closed bodies and meshes); -1: none.
  virtual int inside_of(Vec3 point) const = 0;
  /// The points of all generated checkerboards and dot grids that lie on their surfaces.
  virtual std::vector<PatternPoint> pattern_points() const = 0;
  virtual std::string description() const = 0;
};

/// Compiles surfaces: reads mesh and texture files (relative to `folder`), builds the search trees.
/// @param place where in its file a surface stands ("scene.toml:12:1"), for messages about it; may
///        be empty
/// @throws InputError (also when this build has no Embree), FileError
std::unique_ptr<SurfaceScene> make_surface_scene(const std::vector<SolidSurfaceSpec>& surfaces,
                                                 const std::string& folder,
                                                 const std::vector<SourceFunction>& channels,
                                                 const Execution& execution,
                                                 const std::function<std::string(int)>& place = {});

/// "surface 2" or "surface \"ball\"", for messages.
std::string surface_name(const std::vector<SolidSurfaceSpec>& surfaces, int surface);

}  // namespace plenoflame
