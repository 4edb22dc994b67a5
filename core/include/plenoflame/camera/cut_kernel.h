// Types only: vector kernels include it.
#pragma once

namespace plenoflame {

/// Cuts of the aperture over the distance from the micro-image's centre (PupilCut), as kernels look
/// them up: with d in steps from `opens`, and k its whole part in [0, 15], side j of the cut is
/// value[j][k] + rise[j][k] (d - k), the last factor in [0, 1].
struct CutColumn {
  static constexpr int kSteps = 16;
  alignas(64) float value[4][kSteps], rise[4][kSteps];  ///< [m]
  /// Up to `opens` the stop cuts nothing; beyond `closes` all is cut [m].
  float opens, closes;
  float steps_per_metre;
};

}  // namespace plenoflame
