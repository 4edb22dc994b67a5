#pragma once
#include <vector>

#include "plenoflame/math/vector.h"
#include "plenoflame/optics/ray_status.h"
#include "plenoflame/scene/main_lens_spec.h"

namespace plenoflame {

/// The share of light that a ray's surfaces have not reflected, unpolarised, and what they are
/// coated with (TransmissionSpec in scene/scene.h).
struct PassedLight {
  double coating_index = 0;       ///< 0: uncoated
  double coating_wavelength = 0;  ///< [m] of which the layer is a quarter thick
  double wavelength = 0;          ///< [m] of the light; 0: coating_wavelength
  double share = 1;               ///< falls at every refracting surface that is passed
};

/// A sequence of coaxial surfaces in the camera frame. The first vertex (scene side) is at z =
/// first_vertex, +z points to the scene, later vertices lie at lower z. Immutable.
class LensSystem {
 public:
  LensSystem() = default;
  /// @param surfaces from the scene to the sensor, in air on both sides
  /// @param first_vertex z of the first vertex [m], camera frame
  explicit LensSystem(std::vector<SurfaceSpec> surfaces, double first_vertex = 0);

  const std::vector<SurfaceSpec>& surfaces() const { return surfaces_; }
  const std::vector<double>& vertices() const { return vertices_; }  ///< z of each [m]

  /// Traces a ray that travels towards +z (from the sensor to the scene) through all surfaces, last
  /// one first; exact vector refraction in double precision. Points are appended to `path` when
  /// given. TraceStatus::surface counts from the scene. When the ray does not get through, `ray` is
  /// left at the surface that ended it.
  /// @param passed given: takes off what is reflected
  TraceStatus trace_to_scene(Ray& ray, std::vector<Vec3>* path = nullptr,
                             PassedLight* passed = nullptr) const;
  /// The same in the other direction: towards -z, from the scene to the sensor.
  TraceStatus trace_to_sensor(Ray& ray, std::vector<Vec3>* path = nullptr,
                              PassedLight* passed = nullptr) const;

 private:
  TraceStatus trace(Ray& ray, bool to_scene, std::vector<Vec3>* path, PassedLight* passed) const;
  std::vector<SurfaceSpec> surfaces_;
  std::vector<double> vertices_;
};

}  // namespace plenoflame
