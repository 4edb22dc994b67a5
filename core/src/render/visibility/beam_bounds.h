#pragma once
#include <vector>

#include "plenoflame/camera/pupil_sampling.h"
#include "plenoflame/math/vector.h"
#include "render/visibility/occupied_region.h"

namespace plenoflame {

/// The share of a beam that sees anything.
enum class Visibility {
  none,  ///< certainly
  partial,
  full,  ///< there may be something in all of it: parts of it need no look
};

/// Tells whether the light that a microlens (or, without array, a pixel) can receive meets
/// anything. Conservative: the beam is bounded by discs around rays traced at its edge and within
/// it, with a margin.
///
/// A beam is what goes through a microlens' aperture and the main lens: its focal length does not
/// matter. In a camera that is not aligned it is looked at in the frame of the main lens, from the
/// place where the line to the middle of the exit pupil crosses the plane that the aperture would
/// lie in; how far the aperture is out of that plane widens it. Behind a main lens that is not
/// round nothing is known of beams: all may meet something.
class BeamBounds {
 public:
  /// @param region kept, must live as long; @param tables of the camera's pupils
  BeamBounds(const Camera& camera, const std::vector<PupilTable>& tables,
             const OccupiedRegion& region);

  /// @param place microlens centre or sensor point in the camera's frame [m]
  Visibility look(int table, Vec3 place) const;
  bool may_meet(int table, Vec3 place) const { return look(table, place) != Visibility::none; }

 private:
  Visibility look(int table, Vec2 place, double room) const;
  /// Footprints on the region's two planes, centres along the field direction.
  struct Footprint {
    double centre[2] = {0, 0};
    double radius[2] = {0, 0};
  };
  struct FieldTable {
    double step = 0;
    std::vector<Footprint> nodes;
  };
  const OccupiedRegion* region_;
  /// Places with all that is around them: where whole neighbourhoods see nothing, none of their
  /// microlenses (without array: pixels) is looked at. Not for cameras that are not aligned.
  struct Neighbourhoods {
    int columns = 0, rows = 0;  ///< 0: none
    Vec2 lower, scale;          ///< [m], per metre
    std::vector<bool> dark;     ///< of each table in turn, row by row
  };
  void survey(const Camera& camera);
  bool is_dark(const FieldTable& field, Vec2 middle, double room) const;
  std::vector<FieldTable> fields_;
  Neighbourhoods around_;
  double half_diagonal_ = 0;  ///< [m] of a pixel, without array
  bool everywhere_ = false;  ///< nothing is known, or no region bounded: all beams are looked along
  bool misaligned_ = false;
  RigidTransform to_lens_;   ///< from the camera's frame to that of the main lens
  double plane_ = 0;         ///< z of microlenses or sensor in the aligned camera [m]
  double pupil_ = 0;         ///< z of the exit pupil [m]
  double pupil_radius_ = 0;  ///< [m]
  double aperture_ = 0;      ///< radius of a microlens, or half the diagonal of a pixel [m]
  double tilt_ = 0;          ///< tangent of the angle of the aperture with the plane
};

}  // namespace plenoflame
