#pragma once
#include <array>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "plenoflame/camera/camera.h"
#include "plenoflame/camera/pupil_sampling.h"
#include "plenoflame/math/vector.h"
#include "render/visibility/occupied_region.h"

namespace plenoflame {

class PixelBeam;

/// The pixels behind a microlens that can see anything through it. The test is conservative: a disc
/// on each of the region's two planes bounds a pixel's beam. The middle of the disc is linear in
/// the sensor point. Its radius follows from traced rays, with a margin.
///
/// If the array resolves anything, the whole beam of a microlens (BeamBounds) is several pixel
/// images wide. Not for cameras without array, misaligned ones, and main lenses that are not round.
class PixelBeams {
 public:
  /// @param camera, tables, region kept by reference
  /// @return nullptr if no bounds are known
  static std::unique_ptr<const PixelBeams> make(const Camera& camera,
                                                const std::vector<PupilTable>& tables,
                                                const OccupiedRegion& region);

  /// @param place microlens centre in the camera's frame [m]
  PixelBeam of(int table, Vec2 place) const;

 private:
  friend class PixelBeam;
  static constexpr std::size_t kRings =
      13;  ///< of sensor points, from the micro-image's centre outwards
  /// The beam of a sensor point is centred at centre[k] + diag(along[k], across[k]) w on plane k.
  /// The first coordinate is along the direction away from the axis. The second one is across it,
  /// and the direction is a line of mirror symmetry.
  struct Map {
    double centre[2] = {0, 0}, along[2] = {0, 0}, across[2] = {0, 0};  ///< [m]
    /// @param w sensor point from the micro-image's centre, in units of Interval::outer
    Vec2 at(std::size_t plane, Vec2 w) const {
      return {centre[plane] + along[plane] * w.x, across[plane] * w.y};
    }
    Map mixed(const Map& other, double t) const;
  };
  /// The range between two neighbouring fields of a table. It is traced at its first use, since
  /// most ranges are never used.
  struct Interval {
    std::once_flag once;
    double outer = 1;  ///< [m] radius of the micro-image
    Map ends[2];
    std::array<double, kRings> radii{};  ///< [m] of the discs; infinite: unknown
  };
  struct Table {
    const PupilTable* pupils = nullptr;
    std::vector<Interval> intervals;
  };
  struct Spot;
  PixelBeams(const Camera& camera, const std::vector<PupilTable>& tables,
             const OccupiedRegion& region);
  std::vector<Spot> spots(int table, double h, double outer) const;
  static std::optional<Map> map_of(const std::vector<Spot>& spots);
  void trace(int table, std::size_t i, Interval& interval) const;

  Camera camera_;  ///< with circular apertures, whose symmetry around the axis is used
  const OccupiedRegion& region_;
  double planes_[2];
  double half_diagonal_;  ///< of a pixel [m]
  mutable std::vector<Table> tables_;
};

/// The pixels behind one microlens.
class PixelBeam {
 public:
  /// @param pixel its centre, from the microlens' centre, camera x, y [m]
  bool may_meet(Vec2 pixel) const;
  /// Tells whether something lies behind the rim of the micro-image all around. Most likely all
  /// pixels meet it, and tests of them would be in vain.
  bool is_surrounded() const;

 private:
  friend class PixelBeams;
  const OccupiedRegion* region_ = nullptr;
  const PixelBeams::Interval* interval_ = nullptr;
  /// A PixelBeams::Map from the microlens' centre, in camera x, y.
  struct Seen {
    Vec2 foot, by_x, by_y;
    Vec2 at(Vec2 pixel) const { return foot + pixel.x * by_x + pixel.y * by_y; }
  };
  Seen planes_[2], between_;
  Vec2 field_;         ///< unit vector away from the axis
  double centre_ = 0;  ///< [m] of the micro-image, along field_
  double half_ = 0;    ///< half a pixel's diagonal [m]
};

}  // namespace plenoflame
