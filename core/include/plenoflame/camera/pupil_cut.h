#pragma once
#include <array>
#include <vector>

#include "plenoflame/camera/cut_kernel.h"
#include "plenoflame/math/vector.h"

namespace plenoflame {

/// Bounds of that part of a microlens' aperture from which a sensor point sees the scene.
///
/// A line runs from the micro-image's centre through the sensor point, and in the aim plane through
/// the centre of the microlens. Coordinate p counts along it, q across. Open points satisfy
///
///     low <= p <= high,
///     q^2 <= (p - low) (low_far - p),
///     q^2 <= (high - p) (p - high_far):
/// two circles, each through one end and centred on the line. Stored as (-low, high, low_far,
/// -high_far) [m]: every larger number is a wider bound.
using PupilCut = std::array<float, 4>;

/// Cuts over the distance from the micro-image's centre: linear between equal steps.
struct PupilColumn {
  static constexpr int kSteps = CutColumn::kSteps;
  /// Up to `opens` the stop cuts nothing; beyond `closes` all is cut [m].
  float opens = 0, closes = 0;
  alignas(16) std::array<PupilCut, kSteps + 1> cuts{};

  /// @return the step, with its part: clamped to [0, kSteps]
  float step_at(float distance) const { return step_at(distance, opens, closes); }
  static float step_at(float distance, float opens, float closes) {
    const float length = closes - opens;
    const float step = length > 0 ? (distance - opens) * (kSteps / length) : 0.0f;
    return step > 0 ? (step < kSteps ? step : static_cast<float>(kSteps)) : 0.0f;
  }
  float distance_at(int step) const {
    return opens + static_cast<float>(step) * ((closes - opens) / kSteps);
  }
  static PupilColumn mix(const PupilColumn& a, const PupilColumn& b, float t);
  /// Nowhere narrower, and open as far as `farther`, which is not less than `closes` [m].
  PupilColumn reaching(float farther) const;
};

/// A column between two others, which mixes only the values that are read; refers to both.
class ColumnBetween {
 public:
  ColumnBetween(const PupilColumn& a, const PupilColumn& b, float t) : a_(a), b_(b), t_(t) {}
  float closes() const { return a_.closes + t_ * (b_.closes - a_.closes); }
  float step_at(float distance) const {
    return PupilColumn::step_at(distance, a_.opens + t_ * (b_.opens - a_.opens), closes());
  }
  PupilCut at(float step) const;
  PupilColumn mixed() const { return PupilColumn::mix(a_, b_, t_); }

 private:
  const PupilColumn &a_, &b_;
  float t_;
};

/// The cuts of one place of a microlens over the azimuth of the sensor point about the
/// micro-image's centre. The azimuth is measured from the direction away from the optical axis,
/// which lies in a mirror plane.
class PupilCuts {
 public:
  static constexpr int kAzimuths = kCutAzimuths;
  static float azimuth_cosine(int azimuth);

  std::array<PupilColumn, kAzimuths> columns;

  /// A table between two.
  static PupilCuts mix(const PupilCuts& a, const PupilCuts& b, float t);
  /// Index of the azimuth before, and the way to the next in [0, 1].
  struct Azimuth {
    int index;
    float part;
  };
  static Azimuth azimuth(float cosine);
  ColumnBetween at(const Azimuth& azimuth) const&;
  ColumnBetween at(const Azimuth& azimuth) && = delete;  // it would refer to what is gone
};

/// At a distance from the micro-image's centre [m].
PupilCut cut_at(const CutColumn& column, float distance);
/// The same cut at every distance.
CutColumn constant_cut(const PupilCut& cut);

/// The part of a microlens' aperture that a pixel sees.
struct PixelView {
  bool dark = false;                  ///< nothing gets from the pixel through the microlens
  bool open = false;                  ///< the stop cuts nothing
  const CutColumn* column = nullptr;  ///< holds for all points of the pixel
};

/// Columns that are at least as wide as all azimuths of a sector.
class PixelCuts {
 public:
  PixelCuts() = default;
  explicit PixelCuts(const PupilCuts& cuts);
  /// Between two others; in place, as they are large.
  void set_mix(const PixelCuts& a, const PixelCuts& b, float t);

  /// Refers to these cuts.
  /// @param centre of the pixel, from the micro-image's [m] @param half its side [m]
  /// @param field unit vector away from the optical axis, in the axes of the pixel's sides
  PixelView look(Vec2 centre, double half, Vec2 field) const&;
  PixelView look(Vec2 centre, double half, Vec2 field) && = delete;
  /// Pixels farther than this from the micro-image's centre [m] have their own sector. Nearer
  /// pixels take the column for all. @param half half their side [m]
  static double clear_of_centre(double half);
  /// One around each azimuth of the table, and one for all.
  static constexpr int kSectors = PupilCuts::kAzimuths + 1;
  const CutColumn& sector(int number) const { return columns_[static_cast<std::size_t>(number)]; }

 private:
  std::array<CutColumn, kSectors> columns_;
};

}  // namespace plenoflame
