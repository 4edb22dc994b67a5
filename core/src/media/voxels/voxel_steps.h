#pragma once
#include <vector>

#include "plenoflame/radiometry/source_function.h"

namespace plenoflame::voxel {

/// The number of intervals per cell of a brick with which two Gauss nodes per interval suffice: the
/// kernel's step codes (media/voxels/voxel_kernel.h).
class StepPlanner {
 public:
  /// @param tolerance share of a brick's emission that the quadrature of one cell may miss; 0: one
  ///        interval in every cell, however steep.
  StepPlanner(const std::vector<SourceFunction>& channels, double tolerance)
      : channels_(&channels), tolerance_(tolerance) {}

  /// @param pairs the brick's samples, (temperature, absorption)
  /// @param one_value_per_cell cells have the value of their lowest sample
  /// @param own_temperature temperature is on another lattice: `pairs` holds absorption only
  /// @param extras `extra_fields` further fields, kBrickPairs samples each
  /// @param words kStepWords codes, overwritten
  void plan(const float* pairs, bool one_value_per_cell, bool own_temperature, const float* extras,
            int extra_fields, int* words) const;

 private:
  void subdivide(const float* pairs, int* codes) const;

  const std::vector<SourceFunction>* channels_;
  double tolerance_;
};

}  // namespace plenoflame::voxel
