#pragma once
#include <array>
#include <vector>

#include "plenoflame/camera/pupil_sampling.h"

namespace plenoflame {

/// Distances out to which pixels of a micro-image are worth so many rays.
///
/// A pixel's worth is the share of the microlens' aperture that it sees open. Of all points it gets
/// the part (worth / kWorthOfFew)^(2/3), rounded up to a power of two: level k, of 2^-k of the
/// points, is for what is worth less than kWorthOfFew 2^(-3k/2). That power is best where errors
/// are in proportion to flux and fall with points as 1/n; but pixels that see slivers scatter more
/// than their flux says (docs/theory/errors.md has the figures).
class WorthLevels {
 public:
  static constexpr std::size_t kCount = 6;
  static constexpr double kWorthOfFew = 0.35;
  /// As set_up_rows() finds it (render/pixel_row_kernel.h).
  static int of(double worth);
  /// The limit of level k: places that are worth no more have a level above k.
  static double limit(std::size_t k);

  /// Levels over the distance from the centre of the micro-image of a microlens.
  struct Rings {
    std::array<double, kCount> squares{};  ///< beyond each the next level begins [m^2]
    int at(double distance2) const {
      int level = 0;
      for (const double square : squares) level += distance2 > square ? 1 : 0;
      return level;
    }
  };
  /// @param half half the side of a pixel [m]
  WorthLevels(const PupilTable& table, double half);
  /// @param h distance of the microlens from the optical axis [m]
  Rings at(double h) const;

 private:
  double per_step_;
  std::vector<Rings> nodes_;
};

}  // namespace plenoflame
