#pragma once
#include <array>
#include <cstddef>

#include "plenoflame/math/vector.h"

namespace plenoflame {

/// The place at which a ray from the sensor through a microlens crosses a surface behind, from the
/// microlens' axis. Polynomial of fifth order in sensor point and aim point, both from the
/// microlens' centre. Rotational symmetry leaves these terms (Welford, Aberrations of Optical
/// Systems, 1986, 6.2).
struct RayCrossing {
  static constexpr std::size_t kTerms = 10;
  double unit = 1;  ///< of sensor and aim points [m]
  /// Coefficients of the sensor point and the aim point: polynomials of second degree in s.s, s.u
  /// and u.u. The order of terms is 1, ss, su, uu, ss ss, ss su, ss uu, su su, su uu, uu uu.
  std::array<double, kTerms> of_sensor{}, of_aim{};

  /// The terms of a ray, whose points are in units.
  static std::array<double, kTerms> terms(Vec2 sensor, Vec2 aim);
  Vec2 at(Vec2 sensor, Vec2 aim) const;
};

/// The places at which rays across the plane of the exit pupil meet the stop, in radii of the stop.
/// Valid for microlenses at one distance from the optical axis, to third order. The first axis
/// points away from the optical axis and lies in a mirror plane.
struct StopMap {
  std::array<double, 6> along{};   ///< 1, x, x^2, y^2, x^3, x y^2
  std::array<double, 4> across{};  ///< y, x y, x^2 y, y^3
  /// No ray that reaches the scene is found farther from the stop's middle [1]; 0: not known.
  double reach = 0;

  bool known() const { return reach > 0; }
  Vec2 at(Vec2 crossing) const;
  /// The map between two; known where both are.
  static StopMap mix(const StopMap& a, const StopMap& b, double t);
};

}  // namespace plenoflame
