#pragma once
#include <vector>

#include "plenoflame/inverse/camera_rays.h"
#include "plenoflame/inverse/linear_operator.h"
#include "plenoflame/inverse/measurement.h"

namespace plenoflame {

/// Unknowns that dark pixels rule out, because none is negative.
struct RuledOut {
  std::vector<char> empty;
  /// Deviation of the light in each of them, which noise of their pixels hides; 0 for the others.
  /// The places along a ray are independent.
  std::vector<double> hidden;
};

/// Unknowns with a large part of their light in dark pixels of some view; of several, the view that
/// hides least counts.
/// @param support 0 for unknowns without light; empty: none is known
RuledOut behind_dark(const LinearOperator& a, const CameraRays& rays, const MeasuredRows& measured,
                     std::size_t views, const std::vector<char>& support);

}  // namespace plenoflame
