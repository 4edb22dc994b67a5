#pragma once
#include <vector>

#include "plenoflame/camera/pupil_sampling.h"
#include "plenoflame/math/vector.h"

namespace plenoflame {

/// Whether the light that a microlens (or, without array, a sensor point) can receive meets a box.
/// Conservative: the beam is bounded by discs around its traced edge rays, with a margin.
class BeamBounds {
 public:
  /// @param box world; @param tables of the camera's pupils
  BeamBounds(const Camera& camera, const std::vector<PupilTable>& tables, const Box& box);

  /// @param place microlens centre or sensor point, camera x, y [m]
  bool may_meet(int table, Vec2 place) const;

 private:
  /// Footprints on the two planes that bracket the box, centres along the field direction.
  struct Footprint {
    double centre[2] = {0, 0};
    double radius[2] = {0, 0};
  };
  struct FieldTable {
    double step = 0;
    std::vector<Footprint> nodes;
  };
  std::vector<FieldTable> fields_;
  Vec2 lower_, upper_;        ///< of the box across the axis, camera x, y [m]
  double half_diagonal_ = 0;  ///< [m] of a pixel, without array
  bool always_ = false;       ///< the box is beside or behind the camera's front: no test possible
};

}  // namespace plenoflame
