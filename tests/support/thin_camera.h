// A camera with a thin lens, and what it sees of boards: a projection that shares nothing with the
// camera's rays.
#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "plenoflame/calibration/geometry_calibration.h"
#include "plenoflame/camera/microlens_lattice.h"

namespace plenoflame::test::thin_camera {

inline CameraSpec truth() {
  CameraSpec camera;
  camera.lens.model = LensModel::ideal;
  camera.lens.focal_length = 0.0502;
  camera.lens.diameter = 0.0125;
  camera.lens.decentre = {0.2e-3, -0.1e-3};
  camera.array.present = true;
  camera.array.model = LensModel::ideal;
  camera.array.pitch = camera.array.diameter = 126e-6;
  camera.array.rotation = 0.004;
  camera.array.offset = {20e-6, -30e-6};
  camera.array.sensor_distance = 0.40e-3;
  camera.array.types = {{"all", kInfinity, kInfinity, 1.5, 0.55e-3}};
  camera.sensor.columns = 1600;
  camera.sensor.rows = 1200;
  camera.sensor.pixel_pitch = 5.5e-6;
  camera.focus.mode = FocusMode::distance;
  camera.focus.lens_distance = 0.0567;
  return camera;
}

/// Sensor point of a point at p (camera axes) behind a microlens at c: the thin lens images p,
/// and a straight line goes from that through c.
inline Vec2 thin_projection(const CameraSpec& s, Vec3 p, Vec2 c) {
  const Vec2 d = s.lens.decentre;
  const Vec2 t{(p.x - d.x) / p.z, (p.y - d.y) / p.z};
  const double behind = 1 / (1 / s.lens.focal_length - 1 / p.z);
  const Vec2 image = d - behind * t;
  const double a = s.focus.lens_distance - behind;  // from the array to the image, towards the lens
  return c + (s.array.sensor_distance / a) * (c - image);
}

/// OpenCV's map from true to imaged directions.
inline Vec2 bent(const DistortionSpec& d, Vec2 t) {
  const double r2 = dot(t, t), radial = 1 + r2 * (d.k1 + r2 * (d.k2 + r2 * d.k3));
  return radial * t + Vec2{2 * d.p1 * t.x * t.y + d.p2 * (r2 + 2 * t.x * t.x),
                           d.p1 * (r2 + 2 * t.y * t.y) + 2 * d.p2 * t.x * t.y};
}

/// The same of a lens that distorts. Through each place a of the lens a point is seen in the true
/// direction of a point of the plane at d.distance, and imaged as another point of that plane: a is
/// searched for from which the ray goes on through the middle of the microlens.
inline Vec2 bent_projection(const CameraSpec& s, Vec3 p, Vec2 c) {
  const DistortionSpec& d = s.lens.distortion;
  const double focus = d.distance, behind = 1 / (1 / s.lens.focal_length - 1 / focus);
  const double to_array = s.focus.lens_distance;
  const auto miss = [&](Vec2 a) {
    const Vec2 seen = a + (focus / p.z) * (Vec2{p.x, p.y} - a);
    const Vec2 t = (1 / focus) * (seen - s.lens.decentre);
    const Vec2 image = s.lens.decentre - behind * bent(d, t);
    return a + (to_array / behind) * (image - a) - c;
  };
  Vec2 a = s.lens.decentre;
  for (int step = 0; step < 20; ++step) {
    const double h = 1e-6;
    const Vec2 m = miss(a), u = (1 / h) * (miss(a + Vec2{h, 0}) - m),
               v = (1 / h) * (miss(a + Vec2{0, h}) - m);
    const double determinant = u.x * v.y - v.x * u.y;
    a = a - (1 / determinant) * Vec2{v.y * m.x - v.x * m.y, u.x * m.y - u.y * m.x};
  }
  return c + (s.array.sensor_distance / to_array) * (c - a);
}

/// Radius of the image of a point at a distance z through the whole microlens [pixel]: a cone of
/// light from the lens' image of the point, bent by the microlens.
inline double blur_at(const CameraSpec& s, double z, int type) {
  const double image = 1 / (1 / s.lens.focal_length - 1 / z),
               from_array = s.focus.lens_distance - image,
               f = s.array.types[static_cast<std::size_t>(type)].focal_length;
  const double cone = 1 / from_array - 1 / f;  // by which it widens behind the microlens
  return 0.5 * s.array.diameter * (1 + cone * s.array.sensor_distance) / s.sensor.pixel_pitch;
}

struct Seen {
  std::vector<CornerObservation> corners;
  std::vector<CentreObservation> centres;
  std::vector<double> distances;  ///< [m] of the boards' middles along the axis
};

/// How a real camera differs from the model.
struct Deviations {
  double pupil = 0;  ///< the lens' distance from the array over the exit pupil's is 1 + pupil
  double outwards[3] = {0, 0, 0};  ///< relative displacement of corners, by type of microlens
  double wave = 0;                 ///< [m] by which the board leaves its plane
  double blur = 0;                 ///< [pixel] noise of the corners' blur; 0: blur is not observed
  double blur_scale = 0, blur_offset = 0;  ///< by which all blur is larger: a share, and [pixel]
};

/// How far the board's point leaves its plane: two waves along x, one along y.
inline double wave_at(const Deviations& deviations, Vec2 board) {
  return deviations.wave * (std::sin(240 * board.x) + 0.5 * std::cos(150 * board.y));
}

inline Seen observe(const CameraSpec& s, int poses, double noise, double tilts = 1,
                    const Deviations& deviations = {}, std::uint64_t seed = 11) {
  const MicrolensLattice lattice(s.array);
  const Vec2 size = s.sensor.size();
  const auto pixel = [&](Vec2 at) {
    return Vec2{0.5 * s.sensor.columns - at.x / s.sensor.pixel_pitch,
                0.5 * s.sensor.rows - at.y / s.sensor.pixel_pitch};
  };
  std::mt19937_64 random(seed);
  std::normal_distribution<double> error(0, noise);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-1, 1);
  const double ratio = s.array.sensor_distance / s.focus.lens_distance * (1 + deviations.pupil);
  const auto centre_of = [&](Vec2 c) { return c + ratio * (c - s.lens.decentre); };
  const auto lenses = lattice.within(-0.5 * size, 0.5 * size);
  Seen seen;
  for (std::size_t i = 0; i < lenses.size(); i += 7) {
    const Vec2 at = pixel(centre_of(lattice.centre(lenses[i])));
    seen.centres.push_back({lenses[i], at + Vec2{error(random), error(random)}});
  }
  for (int pose = 0; pose < poses; ++pose) {
    const Vec3 angles{0.5 * uniform(random), 0.5 * uniform(random), 0.4 * uniform(random)};
    const Mat3 turn = rotation_xyz(tilts * angles);
    const Vec3 place{2e-3 * uniform(random), 2e-3 * uniform(random), 0.33 + 0.03 * uniform(random)};
    seen.distances.push_back(place.z);
    for (int i = -3; i <= 3; ++i)
      for (int j = -2; j <= 2; ++j) {
        const Vec2 board{7e-3 * i, 7e-3 * j};
        const Vec3 p = turn * Vec3{board.x, board.y, wave_at(deviations, board)} + place;
        for (std::size_t k = 0; k < lenses.size(); ++k) {
          const Vec2 c = lattice.centre(lenses[k]);
          Vec2 at = s.lens.distortion.none() ? thin_projection(s, p, c) : bent_projection(s, p, c);
          const double outwards =
              deviations.outwards[static_cast<std::size_t>(lattice.type(lenses[k]))];
          at = at + outwards * (at - centre_of(c));
          if (length(at - centre_of(c)) > 9 * s.sensor.pixel_pitch ||
              std::fabs(at.x) > 0.5 * size.x || std::fabs(at.y) > 0.5 * size.y)
            continue;
          CornerObservation& corner = seen.corners.emplace_back();
          corner = {pose, board, pixel(at) + Vec2{error(random), error(random)}, lenses[k]};
          if (deviations.blur == 0) continue;
          corner.blur = (1 + deviations.blur_scale) * blur_at(s, p.z, lattice.type(lenses[k])) +
                        deviations.blur_offset + deviations.blur * normal(random);
          corner.blur_error = deviations.blur;
        }
      }
  }
  return seen;
}

/// Nominal values, as a data sheet gives them.
inline CameraSpec nominal() {
  CameraSpec camera = truth();
  camera.lens.focal_length = 0.05;
  camera.focus.lens_distance = 0.0565;
  camera.array.sensor_distance = 0.39e-3;
  camera.lens.decentre = {};
  camera.array.offset = {15e-6, -24e-6};
  camera.array.rotation = 0.0041;
  return camera;
}

inline double value_of(const CameraSpec& camera, const std::string& key) {
  if (key == "camera.lens.focal_length") return camera.lens.focal_length;
  if (key == "camera.focus.lens_distance") return camera.focus.lens_distance;
  if (key == "camera.array.sensor_distance") return camera.array.sensor_distance;
  if (key.starts_with("camera.array.types["))
    return camera.array.types[static_cast<std::size_t>(key[19] - '0')].focal_length;
  if (key == "camera.lens.decentre[0]") return camera.lens.decentre.x;
  if (key == "camera.lens.decentre[1]") return camera.lens.decentre.y;
  if (key == "camera.array.offset[0]") return camera.array.offset.x;
  if (key == "camera.array.offset[1]") return camera.array.offset.y;
  if (key == "camera.array.pitch") return camera.array.pitch;
  if (key == "camera.array.rotation") return camera.array.rotation;
  if (key == "camera.array.tilt[0]") return camera.array.tilt.x;
  if (key == "camera.array.tilt[1]") return camera.array.tilt.y;
  const DistortionSpec& d = camera.lens.distortion;
  if (key == "camera.lens.distortion.k1") return d.k1;
  if (key == "camera.lens.distortion.k2") return d.k2;
  if (key == "camera.lens.distortion.k3") return d.k3;
  if (key == "camera.lens.distortion.p1") return d.p1;
  if (key == "camera.lens.distortion.p2") return d.p2;
  if (key == "camera.lens.distortion.distance") return d.distance;
  ADD_FAILURE() << key;
  return 0;
}

}  // namespace plenoflame::test::thin_camera
