#pragma once
#include <string>

#include "plenoflame/math/vector.h"

namespace plenoflame {

/// Shapes of windows in their own frame.
enum class WindowShape {
  plate,  ///< plane-parallel, from z = 0 to the thickness, centred in x and y
  wedge,  ///< the same, but for the face at the thickness, which rises towards +y by the angle
  tube,   ///< around z, from z = 0 to the height
  dome,   ///< part of a spherical shell around the origin, up to +z, as high as the height
};

/// A transparent body in air that refracts the light on its way to the camera.
struct WindowSpec {
  WindowShape shape = WindowShape::plate;
  std::string name = {};
  Vec3 position;           ///< [m] world place of the origin of its own frame
  Vec3 rotation;           ///< [rad] about x, then y, then z of the world
  double thickness = 0;    ///< [m] of plate and wall; of a wedge in the middle
  double diameter = 0;     ///< [m] plate, wedge: round, of this diameter; 0: as `extent` says
  Vec2 extent;             ///< [m] plate, wedge: full sides along x and y
  double angle = 0;        ///< [rad] wedge: between its faces
  double radius = 0;       ///< [m] tube, dome: of the outer face
  double height = 0;       ///< [m] tube: length; dome: from its rim to the top of the outer face
  std::string glass = {};  ///< as of a surface; empty: `index` as it is
  double index = 1.5;
  double absorption = 0;  ///< [1/m] of the glass
  bool fresnel = false;   ///< whether its faces reflect a part of the light
  friend bool operator==(const WindowSpec&, const WindowSpec&) = default;
};

}  // namespace plenoflame
