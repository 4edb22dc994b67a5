#pragma once
#include <limits>

#include "plenoflame/camera/camera.h"

namespace plenoflame {

/// The camera with its stop wide open: corners may be seen by rays that its own stop ends.
inline Camera open_camera(CameraSpec spec) {
  spec.lens.diameter *= 2;
  spec.array.diameter = spec.array.pitch;
  spec.array.diameter_y = 0;
  spec.array.aperture = ApertureShape::circular;
  spec.focus.mode = FocusMode::distance;
  return Camera(spec);
}

/// The straight line that is seen at a pixel through the middle of a microlens.
struct SeenLine {
  Vec2 place, slope;  ///< at z = 0, and dx/dz, dy/dz
  Vec2 at(double z) const { return place + z * slope; }
};

inline SeenLine seen_line(const Camera& camera, LensIndex lens, Vec2 sensor_point) {
  const Vec3 middle = camera.lens_place(lens);
  const Ray ray = camera.trace(sensor_point, lens, {middle.x, middle.y}).exit;
  const Vec2 slope{ray.direction.x / ray.direction.z, ray.direction.y / ray.direction.z};
  return {Vec2{ray.origin.x, ray.origin.y} - ray.origin.z * slope, slope};
}

/// The point at which that line meets the plane of the main lens, from its middle.
inline Vec2 at_main_lens(const Camera& camera, LensIndex lens, Vec2 sensor_point) {
  return camera.at_stop(sensor_point, lens)
      .value_or(Vec2{std::numeric_limits<double>::quiet_NaN(), 0});
}

/// Inverse of the derivative of a function of the sensor point, times -1 / pixel: what turns a miss
/// into pixels.
struct ToPixels {
  double xx = 0, xy = 0, yx = 0, yy = 0;
  Vec2 operator()(Vec2 miss) const {
    return {xx * miss.x + xy * miss.y, yx * miss.x + yy * miss.y};
  }
};

template <class Function>
ToPixels to_pixels(const Camera& camera, Vec2 s, const Function& f) {
  const Vec2 p = camera.spec().sensor.pixel();
  const double h = 0.01;
  const Vec2 u = (0.5 / h) * (f(s + Vec2{h * p.x, 0}) - f(s - Vec2{h * p.x, 0}));
  const Vec2 v = (0.5 / h) * (f(s + Vec2{0, h * p.y}) - f(s - Vec2{0, h * p.y}));
  const double determinant = u.x * v.y - v.x * u.y;
  // The picture is upside down on the sensor.
  const double k = -1 / determinant;
  return {k * v.y, -k * v.x, -k * u.y, k * u.x};
}

}  // namespace plenoflame
