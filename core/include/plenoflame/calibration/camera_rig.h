#pragma once
#include <vector>

#include "plenoflame/math/vector.h"

namespace plenoflame {

/// The place of a second camera, found by boards that both have seen.
struct RelativePose {
  RigidTransform to_first;    ///< second camera's frame to the first one's [m]
  double place_error = 0;     ///< [m] standard error of the place, in all three directions together
  double turn_error = 0;      ///< [rad] the same of the rotation
  double rms = 0;             ///< [m] by which the boards' points of both cameras differ
  std::vector<double> apart;  ///< [m] the same of each board
};

/// @param first, second boards to camera, of the same boards in the same order
/// @param size [m] of the boards, about: a rotation counts by the displacement at this distance
/// @throws InputError without a board
RelativePose register_cameras(const std::vector<RigidTransform>& first,
                              const std::vector<RigidTransform>& second, double size);

}  // namespace plenoflame
