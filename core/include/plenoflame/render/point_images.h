#pragma once
#include <functional>
#include <vector>

#include "plenoflame/camera/camera.h"

namespace plenoflame {

/// The image of a point through one microlens.
struct PointImage {
  LensIndex lens;
  int type = -1;  ///< of the microlens; -1 without array
  /// Centroid of the arriving light, in continuous coordinates of the upright image: pixel (0, 0)
  /// has its centre at (0.5, 0.5).
  double column = 0, row = 0;
  double spread = 0;  ///< [pixels] root mean square distance of the light from the centroid
  /// Share of this microlens in the light of the point that reaches the sensor.
  double share = 0;
};

/// Tells whether something blocks the light of a point on its way to the camera. @param direction
/// [world], unit
/// @param length [m] to the front of the camera
using LightStop = std::function<bool(Vec3 direction, double length)>;

/// The images of a point. Rays are spread evenly over the camera's aperture, followed to the sensor
/// and weighted by their etendue. A microlens that is only partly lit has an image, too. Images
/// whose centroid is off the sensor are left out. Ordered by q, then r.
/// @param world [m]; a point that is not in front of the camera has no images
/// @param rays over the aperture; some tens for each microlens that sees the point give its
/// centroid to a hundredth of its spread
std::vector<PointImage> point_images(const Camera& camera, Vec3 world, int rays,
                                     const LightStop& stopped = {});

}  // namespace plenoflame
