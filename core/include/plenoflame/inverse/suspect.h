#pragma once
#include <cmath>
#include <cstddef>

namespace plenoflame {

/// A quantity of a camera or of the flame that the model treats as known, and that may be wrong.
enum class SuspectKind {
  exposure,     ///< relative to those of the other cameras
  stray_light,  ///< [W] the same in every row
  right,        ///< [m] place of the camera, across its line of sight
  up,           ///< [m] the same upwards
  forward,      ///< [m] the same along its line of sight
  turn,         ///< [rad] about the line of sight
  /// Relative change of the distance in focus. In the mode `distance` it is the relative reduction
  /// of the distance from lens to array.
  focus,
  absorption,  ///< relative, everywhere; of no camera
};

/// A test of such a quantity against the pictures (Rao's score test).
struct Suspect {
  SuspectKind kind = SuspectKind::exposure;
  std::size_t view = 0;
  double estimate = 0;   ///< error of the model's value, if no other quantity is wrong
  double deviation = 0;  ///< of the estimate, the error of the model included
  /// The pictures show that it is wrong, together with other named ones. Estimates of named
  /// quantities belong together.
  bool named = false;
  bool is_same(const Suspect& other) const { return kind == other.kind && view == other.view; }
  double significance() const { return deviation > 0 ? std::fabs(estimate / deviation) : 0; }
};

}  // namespace plenoflame
