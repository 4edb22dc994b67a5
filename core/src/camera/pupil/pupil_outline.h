#pragma once
#include <array>
#include <vector>

#include "camera/pupil/pupil_tracer.h"
#include "plenoflame/camera/pupil_sampling.h"

namespace plenoflame {

/// The sensor points that see the scene through each point of the aim plane, for a microlens at
/// distance h from the axis. They are traced on polar grids, one for each azimuth of the sensor
/// point.
///
/// A grid fills the aperture's disc, which moves with the sensor point. For a point of the
/// grid and an azimuth, the stop is open for an interval of distances from the micro-image's
/// centre.
class PupilOutline {
 public:
  /// @param centre of the micro-image on the axis that points away from the optical axis [m]
  /// @param range first distance at which the end of the micro-image is searched [m]
  PupilOutline(PupilTracer& open, double h, double centre, double range,
               const ApertureDiscs& discs);

  bool dark() const { return dark_; }
  /// Onset and cutoff of vignetting by the stop, without margins [m].
  const std::array<double, PupilCuts::kAzimuths>& opens() const { return opens_; }
  const std::array<double, PupilCuts::kAzimuths>& closes() const { return closes_; }
  /// The cuts at steps from opens to closes, which may be wider than those of the outline itself.
  void fill_cuts(PupilCuts& cuts) const;
  /// Share of the aperture that sees the scene, averaged over the azimuths and integrated over the
  /// distances up to this one [m].
  double opened(double distance) const;
  /// Rays at the ends of the intervals, and some inside, in the plane z = 0 of the camera frame.
  const std::vector<Ray>& beam_rays() const { return beam_rays_; }

 private:
  static constexpr int kRings = 7, kSpokes = 16;
  static constexpr std::size_t kPoints = 1 + kRings * kSpokes;
  struct Interval {
    double in = 0, out = -1;  ///< out < in: none
  };
  using Grid = std::array<Interval, kPoints>;
  Vec2 sensor_point(int azimuth, double distance) const;
  Vec2 aim(int azimuth, double distance, std::size_t i) const;
  static bool bounds_beam(std::size_t i);
  double last_inside(int azimuth, std::size_t i) const;
  bool search(PupilTracer& open, double h, int azimuth, double range);
  PupilCut cut(int azimuth, double distance) const;

  double centre_;
  std::array<Vec2, kPoints>
      points_;  ///< of the grid, in the unit disc, first axis along the azimuth
  std::array<Vec2, PupilCuts::kAzimuths> directions_;
  ApertureDiscs discs_;
  std::array<Grid, PupilCuts::kAzimuths> grids_;
  /// Ends of every interval, limited to distances at which the point is inside the bound.
  std::array<std::array<double, kPoints>, PupilCuts::kAzimuths> ends_{};
  std::array<double, PupilCuts::kAzimuths> opens_{}, closes_{};
  std::vector<Ray> beam_rays_;
  bool dark_ = true;
};

}  // namespace plenoflame
