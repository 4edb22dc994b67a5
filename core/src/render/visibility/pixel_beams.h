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

/// The pixels behind a microlens that can see anything through it. Conservative: a pixel's beam is
/// bounded by a disc on each of the region's two planes, its middle linear in the sensor point, as
/// large as traced rays ask for, with a margin.
///
/// A microlens' whole beam (BeamBounds) is several pixels' images wide where the array resolves
/// something. Not for cameras without array, nor for those that are not aligned.
class PixelBeams {
 public:
  /// @param camera, tables, region kept, must live as long
  /// @return nullptr where nothing can be said
  static std::unique_ptr<const PixelBeams> make(const Camera& camera,
                                                const std::vector<PupilTable>& tables,
                                                const OccupiedRegion& region);

  /// @param place microlens centre in the camera's frame [m]
  PixelBeam of(int table, Vec2 place) const;

 private:
  friend class PixelBeam;
  static constexpr std::size_t kRings =
      13;  ///< of sensor points, from the micro-image's centre out
  /// The view of a sensor point lies about centre[k] + diag(along[k], across[k]) w on plane k:
  /// along and across the direction away from the axis, which is a mirror plane.
  struct Map {
    double centre[2] = {0, 0}, along[2] = {0, 0}, across[2] = {0, 0};  ///< [m]
    /// @param w sensor point from the micro-image's centre, in units of Interval::outer
    Vec2 at(std::size_t plane, Vec2 w) const {
      return {centre[plane] + along[plane] * w.x, across[plane] * w.y};
    }
    Map mixed(const Map& other, double t) const;
  };
  /// Between two neighbouring fields of a table: traced when first asked for, as most never are.
  struct Interval {
    std::once_flag once;
    double outer = 1;  ///< [m] the micro-image's radius
    Map ends[2];
    std::array<double, kRings> radii{};  ///< [m] of the discs; infinite: nothing is known
    /// Bounds of the discs for kernels, by distance in units of outer / kBeamBins [m].
    std::array<double, kBeamBins> largest, least;
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
  void sum_up(Interval& interval) const;

  Camera camera_;  ///< with circles, which what is alike all around the axis is made of
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
  /// For a look at many of them at once, which says the same but for the discs of long beams.
  KernelBeam kernel() const;

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
  double centre_ = 0;  ///< of the micro-image, along it [m]
  double half_ = 0;    ///< half a pixel's diagonal [m]
};

}  // namespace plenoflame
