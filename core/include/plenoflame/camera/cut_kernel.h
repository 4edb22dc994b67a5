// Types and numbers only: vector kernels include it.
#pragma once

namespace plenoflame {

/// Cuts of the aperture over the distance from the micro-image's centre (PupilCut), in the form in
/// which kernels look them up. Let d be the distance in steps from `opens`, and k its integer part
/// in [0, 15]. Side j of the cut is value[j][k] + rise[j][k] (d - k), the last factor clamped to
/// [0, 1].
struct CutColumn {
  static constexpr int kSteps = 16;
  alignas(64) float value[4][kSteps], rise[4][kSteps];  ///< [m]
  /// Up to `opens` the stop cuts nothing; beyond `closes` all is cut [m].
  float opens, closes;
  float steps_per_metre;
};

inline constexpr int kCutAzimuths = 9;  ///< equally spaced from 0 to pi
/// cos(pi (k + 1/2) / 8): where the nearest azimuth changes.
inline constexpr double kCutBorders[kCutAzimuths - 1] = {
    0.98078528040323044,  0.83146961230254524,  0.55557023301960222,  0.19509032201612827,
    -0.19509032201612827, -0.55557023301960222, -0.83146961230254524, -0.98078528040323044};
/// Sine of one step: pixels that look larger from the centre take the column for all azimuths.
inline constexpr double kCutSine = 0.38268343236508977;

}  // namespace plenoflame
