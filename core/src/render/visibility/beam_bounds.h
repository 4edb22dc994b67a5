#pragma once
#include <vector>

#include "plenoflame/camera/pupil_sampling.h"
#include "plenoflame/math/vector.h"
#include "render/visibility/occupied_region.h"

namespace plenoflame {

/// Tells whether the light that a microlens (or, without array, a pixel) can receive meets
/// anything. The test is conservative: discs bound the beam, around rays traced at its edge and
/// inside, with a margin.
///
/// A beam passes a microlens' aperture and the main lens; its focal length does not matter. In a
/// misaligned camera the test uses the frame of the main lens. The beam's place is where the line
/// from the aperture to the middle of the exit pupil crosses the plane of an aligned aperture. The
/// distance of the aperture from that plane widens the beam. Behind a main lens that is not round,
/// beams are unknown: all of them may meet something.
class BeamBounds {
 public:
  /// @param region kept by reference; @param tables of the camera's pupils
  BeamBounds(const Camera& camera, const std::vector<PupilTable>& tables,
             const OccupiedRegion& region);

  /// @param place microlens centre or sensor point in the camera's frame [m]
  bool may_meet(int table, Vec3 place) const;

 private:
  bool may_meet(int table, Vec2 place, double room) const;
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
  /// Neighbourhoods of places on the array. If a whole neighbourhood sees nothing, its microlenses
  /// (without array: pixels) need no test of their own. Not for misaligned cameras.
  struct Neighbourhoods {
    int columns = 0, rows = 0;  ///< 0: none
    Vec2 lower, scale;          ///< [m], per metre
    std::vector<bool> dark;     ///< table by table, each row by row
  };
  void survey(const Camera& camera);
  bool is_dark(const FieldTable& field, Vec2 middle, double room) const;
  std::vector<FieldTable> fields_;
  Neighbourhoods around_;
  double half_diagonal_ = 0;  ///< [m] of a pixel, without array
  /// True if beams or a bounded region are unknown: all beams may meet something.
  bool everywhere_ = false;
  bool misaligned_ = false;
  RigidTransform to_lens_;   ///< from the camera's frame to that of the main lens
  double plane_ = 0;         ///< z of microlenses or sensor in the aligned camera [m]
  double pupil_ = 0;         ///< z of the exit pupil [m]
  double pupil_radius_ = 0;  ///< [m]
  double aperture_ = 0;      ///< radius of a microlens, or half the diagonal of a pixel [m]
  double tilt_ = 0;          ///< tangent of the angle of the aperture with the plane
};

}  // namespace plenoflame
