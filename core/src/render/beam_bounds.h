#pragma once
#include <vector>

#include "plenoflame/camera/pupil_sampling.h"
#include "plenoflame/math/vector.h"
#include "render/lit_region.h"

namespace plenoflame {

/// Whether the light that a microlens (or, without array, a pixel) can receive meets anything.
/// Conservative: the beam is bounded by discs around its traced edge rays, with a margin.
class BeamBounds {
 public:
  /// @param region kept, must live as long; @param tables of the camera's pupils
  BeamBounds(const Camera& camera, const std::vector<PupilTable>& tables, const LitRegion& region);

  /// @param place microlens centre or sensor point, camera x, y [m]
  bool may_meet(int table, Vec2 place) const;

 private:
  /// Footprints on the region's two planes, centres along the field direction.
  struct Footprint {
    double centre[2] = {0, 0};
    double radius[2] = {0, 0};
  };
  struct FieldTable {
    double step = 0;
    std::vector<Footprint> nodes;
  };
  const LitRegion* region_;
  std::vector<FieldTable> fields_;
  double half_diagonal_ = 0;  ///< [m] of a pixel, without array
};

}  // namespace plenoflame
