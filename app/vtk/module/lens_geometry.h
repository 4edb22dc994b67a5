#pragma once
#include <vtkSmartPointer.h>

#include <memory>

#include "plenoflame/camera/camera.h"

class vtkPolyData;

/// Surfaces of a camera as polygons with normals, in the world.
namespace plenoflame::pipeline {

/// How finely surfaces of revolution are cut up.
struct Tessellation {
  int sectors = 64;  ///< around the axis
  int rings = 12;    ///< from the vertex to the edge
};

/// Collects caps, rings and bands; polygons carry numbers for colouring.
class SurfaceBuilder {
 public:
  SurfaceBuilder(const RigidTransform& to_world, const Tessellation& tessellation);
  ~SurfaceBuilder();
  SurfaceBuilder(const SurfaceBuilder&) = delete;
  SurfaceBuilder& operator=(const SurfaceBuilder&) = delete;

  /// What the polygons that follow belong to: cell data "surface", "type", "microlens".
  void tag(int surface, int type, LensIndex lens);
  /// Spherical cap, or a disc when the radius is infinite. z = vertex - r^2 / (R (1 + ...)): a
  /// positive radius has its centre towards the sensor, as SurfaceSpec has it. All [m], camera
  /// frame.
  void cap(Vec2 centre, double vertex, double radius, double diameter);
  /// Flat ring around the axis.
  void ring(double z, double inner_diameter, double outer_diameter);
  /// The edge between two circles around the axis.
  void band(double z0, double diameter0, double z1, double diameter1);
  vtkSmartPointer<vtkPolyData> take();

 private:
  struct Internals;
  std::unique_ptr<Internals> in_;
  Tessellation tessellation_;
};

/// z of a surface at height r over its vertex [m]; at most at its equator.
double surface_height(double vertex, double radius, double r);

/// The main lens' surfaces; of an ideal lens its principal planes, as wide as light passes.
vtkSmartPointer<vtkPolyData> lens_surfaces(const Camera& camera, const Tessellation& tessellation);
/// The ground edges of its glasses.
vtkSmartPointer<vtkPolyData> lens_edges(const Camera& camera, const Tessellation& tessellation);
/// The diaphragm: a ring around the clear aperture.
vtkSmartPointer<vtkPolyData> stop_ring(const Camera& camera, const Tessellation& tessellation);
/// A rectangle with texture coordinates for an image whose rows run upwards.
vtkSmartPointer<vtkPolyData> sensor_rectangle(const Camera& camera);

}  // namespace plenoflame::pipeline
