#pragma once
#include <optional>

#include "plenoflame/math/vector.h"
#include "plenoflame/scene/main_lens_spec.h"

namespace plenoflame {

/// Distortion of the main lens as a map of rays outside of it, in the frame of the lens.
///
/// A ray keeps the place p at which it crosses the plane of the entrance pupil. From the pupil's
/// middle, points of the plane in focus are seen in directions u = (dx/dz, dy/dz). The point in
/// direction u is imaged where the lens without distortion images direction v = distorted(u) (D. C.
/// Brown, "Close-range camera calibration", Photogrammetric Engineering 37 (1971) 855):
///
///     v = u (1 + k1 r^2 + k2 r^4 + k3 r^6) + (2 p1 x y + p2 (r^2 + 2 x^2),
///                                             p1 (r^2 + 2 y^2) + 2 p2 x y)
///
/// with u = (x, y) and r = |u|.
class LensDistortion {
 public:
  LensDistortion() = default;  ///< none
  /// @param pupil z of the entrance pupil in the frame of the lens [m]
  /// @throws InputError when the pupil is infinitely far away, or the plane is not in front of it
  LensDistortion(const DistortionSpec& spec, double pupil);

  bool present() const { return present_; }
  const DistortionSpec& spec() const { return spec_; }
  double pupil() const { return pupil_; }                ///< z of the entrance pupil [m]
  double per_distance() const { return per_distance_; }  ///< [1/m] from there to the sharp plane
  /// Steps of Newton's method that undistorted() needs at most within limit().
  static constexpr int kSteps = 8;
  /// The largest |v| up to which there is one direction u for each v, in all azimuths.
  double limit() const { return limit_; }

  /// Lowers the limit to what a camera needs.
  void restrict_to(double limit);
  /// A bound of |v - u| for directions of which one is up to `reach` long.
  double largest_bend(double reach) const;

  Vec2 distorted(Vec2 u) const;
  /// The inverse, to the last digits. None: beyond limit().
  std::optional<Vec2> undistorted(Vec2 v) const;
  /// Determinant of the derivative of distorted(): area in v over area in u.
  double area_ratio(Vec2 u) const;

  /// The ray outside of a lens without distortion to that outside of this lens, which is given at
  /// the pupil, towards +z. False: beyond limit(), the ray stays.
  bool to_scene(Ray& ray) const;
  /// The inverse, for rays in either direction. @param ratio is multiplied by solid angle times
  /// projected area of a thin beam inside over outside
  bool to_lens(Ray& ray, double& ratio) const;
  /// The direction v of a ray outside of a lens without distortion.
  Vec2 direction(const Ray& ray) const;

 private:
  Vec2 newton_step(Vec2 u, Vec2 v) const;
  bool is_well_behaved(double radius) const;
  double find_limit() const;

  bool present_ = false;
  DistortionSpec spec_;
  double pupil_ = 0, per_distance_ = 0, limit_ = 0;
};

}  // namespace plenoflame
