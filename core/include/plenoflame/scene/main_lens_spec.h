#pragma once
#include <string>
#include <vector>

#include "plenoflame/base/constants.h"
#include "plenoflame/math/vector.h"

/// The main lens as plain values (scene.h).
namespace plenoflame {

/// Tells whether an element refracts at its real surfaces or by its paraxial transform.
enum class LensModel {
  real,   ///< exact refraction at every surface
  ideal,  ///< the paraxial transform between the principal planes: no aberrations
};

/// One surface of the main lens. Surfaces are listed from the scene to the sensor.
struct SurfaceSpec {
  double radius = kInfinity;  ///< [m] > 0: centre of curvature on the sensor's side; inf: plane
  double thickness = 0;       ///< [m] to the vertex of the next surface
  double index = 1;           ///< refractive index behind the surface (towards the sensor)
  double diameter = 0;        ///< [m] clear diameter
  bool stop = false;          ///< the aperture stop (exactly one surface)
  /// The shape of a surface that is no sphere: sag = c h^2 / (1 + sqrt(1 - (1 + conic) c^2 h^2)) +
  /// aspheric[i] h^(4 + 2 i), towards the sensor.
  double conic = 0;
  std::vector<double> aspheric = {};  ///< [1/m^3, 1/m^5, ...] from h^4 on, at most 7
  /// A biconic surface in place of `radius`, `conic` and `aspheric`. With c_i = 1 / radius_i, its
  /// sag is (c_x x^2 + c_y y^2) / (1 + sqrt(1 - q)), where q = (1 + conic_x) c_x^2 x^2 + (1 +
  /// conic_y) c_y^2 y^2.
  double radius_x = 0, radius_y = 0;  ///< [m] of the sections along camera x, y; 0 both: it is none
  double conic_x = 0, conic_y = 0;
  /// optics/glass.h; empty: `index` as it is. Otherwise set_indices() has put the index there.
  std::string glass = {};
  friend bool operator==(const SurfaceSpec&, const SurfaceSpec&) = default;
};

/// Deviation of the main lens' imaging directions from those of an ideal lens (the map is in
/// camera/lens_distortion.h). All 0: no distortion.
struct DistortionSpec {
  double k1 = 0, k2 = 0, k3 = 0;  ///< radial
  double p1 = 0, p2 = 0;          ///< tangential
  double distance = kInfinity;    ///< [m] from the front vertex to the plane that stays sharp
  bool none() const { return k1 == 0 && k2 == 0 && k3 == 0 && p1 == 0 && p2 == 0; }
  friend bool operator==(const DistortionSpec&, const DistortionSpec&) = default;
};

/// The main lens: either surfaces, or (model ideal only) focal length and diameter alone.
struct MainLensSpec {
  LensModel model = LensModel::real;
  std::vector<SurfaceSpec> surfaces;
  double focal_length = 0;  ///< [m] used when there are no surfaces: a thin ideal lens at z = 0
  double diameter = 0;      ///< [m] its stop, at the lens
  // Errors of mounting; array, sensor and the camera's position stay where they are.
  Vec2 decentre;  ///< [m] camera x, y: by which the lens is moved across the axis
  Vec2 tilt;      ///< [rad] about camera x, then y, around its front vertex
  DistortionSpec distortion;
  friend bool operator==(const MainLensSpec&, const MainLensSpec&) = default;
};

}  // namespace plenoflame
