#pragma once
#include <cstdint>
#include <initializer_list>
#include <utility>
#include <vector>

#include "plenoflame/camera/camera.h"
#include "plenoflame/image/image.h"
#include "plenoflame/scene/scene.h"

/// Surfaces of a camera as polygons, in the world.
namespace plenoflame {

/// Polygons as plain arrays. Normals, or texture coordinates, have one entry a point where there
/// are any; numbers for colouring one a polygon.
struct CameraMesh {
  std::vector<Vec3> points;   ///< [m]
  std::vector<Vec3> normals;  ///< unit
  std::vector<Vec2> texture;
  std::vector<std::int64_t> offsets{
      0};  ///< where each polygon's corners begin, and the last one's end
  std::vector<std::int64_t> connectivity;  ///< numbers of points
  std::vector<int> surfaces, types;        ///< as Camera numbers surfaces; -1: no microlens
  std::vector<LensIndex> lenses;
  std::size_t polygons() const { return offsets.size() - 1; }
};

/// The fineness with which surfaces of revolution are cut up.
struct Tessellation {
  int sectors = 64;  ///< around the axis
  int rings = 12;    ///< from the vertex to the edge
};

/// Collects caps, rings and bands; polygons carry numbers for colouring.
class SurfaceBuilder {
 public:
  SurfaceBuilder(const RigidTransform& to_world, const Tessellation& tessellation)
      : to_world_(to_world), tessellation_(tessellation) {}

  /// The surface, type and microlens that the polygons that follow belong to.
  void tag(int surface, int type, LensIndex lens);
  /// Spherical cap, or a disc when the radius is infinite: z = vertex - r^2 / (R (1 + ...)). A
  /// positive radius has its centre towards the sensor, as in SurfaceSpec. All [m], camera frame.
  void cap(Vec2 centre, double vertex, double radius, double diameter);
  /// The same within the edge of a microlens' aperture.
  void cap(Vec2 centre, double vertex, double radius, const MicrolensAperture& aperture);
  /// Flat ring around the axis.
  void ring(double z, double inner_diameter, double outer_diameter);
  /// The edge between two circles around the axis.
  void band(double z0, double diameter0, double z1, double diameter1);
  CameraMesh take() { return std::move(mesh_); }

 private:
  template <class Reach>
  void add_cap(Vec2 centre, double vertex, double radius, const Reach& reach);
  std::int64_t point(Vec3 at, Vec3 normal);
  void polygon(std::initializer_list<std::int64_t> ids);
  CameraMesh mesh_;
  RigidTransform to_world_;
  Tessellation tessellation_;
  int surface_ = -1, type_ = -1;
  LensIndex lens_;
};

/// The distance from the middle of a microlens to its edge [m]. @param angle from x towards y
double reach_of(const MicrolensAperture& aperture, double angle);

/// z of a surface at height r over its vertex [m]; at most at its equator.
double surface_height(double vertex, double radius, double r);

/// The main lens' surfaces; of an ideal lens its principal planes, as wide as light passes.
CameraMesh lens_surfaces(const Camera& camera, const Tessellation& tessellation);
/// The ground edges of its glasses.
CameraMesh lens_edges(const Camera& camera, const Tessellation& tessellation);
/// The diaphragm: a ring around the clear aperture.
CameraMesh stop_ring(const Camera& camera, const Tessellation& tessellation);
/// A rectangle with texture coordinates for an image whose rows run upwards.
CameraMesh sensor_rectangle(const Camera& camera);

/// Microlenses whose centres lie in front of a part of the sensor, or within a pitch of it.
/// @param window of the sensor; width 0: all of it
std::vector<LensIndex> microlenses_over(const Camera& camera, PixelWindow window);

/// Both surfaces of each; of ideal microlenses a disc.
CameraMesh microlens_surfaces(const Camera& camera, const std::vector<LensIndex>& lenses,
                              const Tessellation& tessellation);

/// A rectangle as large as the sensor, or as the array, where the array's front is; texture
/// coordinates repeat with the lattice.
CameraMesh array_plate(const Camera& camera);

/// Sides of the rectangle, along the lattice's axes, after which the array repeats [m].
Vec2 array_period(const ArraySpec& array);

enum class ArrayDetail {
  automatic,  ///< every microlens where they are few, else the plate
  plate,
  all,     ///< every microlens
  window,  ///< those over a part of the sensor, and the plate
};

struct CameraMeshRequest {
  ArrayDetail detail = ArrayDetail::automatic;
  std::size_t most_microlenses = 3000;  ///< that are few
  PixelWindow window;
  int lens_sectors = 96, microlens_sectors = 12;
};

/// The whole camera. Without array, or where it is shown otherwise, parts of it are empty.
struct CameraMeshes {
  CameraMesh lens_surfaces, lens_edges, stop, microlenses, plate, sensor;
};

/// @param scene with one camera; it is validated @throws InputError; UsageError: an empty window
CameraMeshes camera_meshes(const Scene& scene, const CameraMeshRequest& request);

}  // namespace plenoflame
