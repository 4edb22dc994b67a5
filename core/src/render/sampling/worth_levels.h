#pragma once
#include <array>
#include <vector>

#include "plenoflame/camera/pupil_sampling.h"

namespace plenoflame {

/// Levels of a micro-image: pixels of level k get 2^-k of the points.
///
/// A pixel's worth is the share of the microlens' aperture that it sees open. The pixel gets the
/// part (worth / kWorthOfFew)^(2/3) of all points, rounded up to a power of two. Level k begins
/// below the worth kWorthOfFew 2^(-3k/2). This power is optimal if errors are proportional to flux
/// and fall with points as 1/n. Pixels that see slivers of the aperture scatter more than that
/// (docs/theory/errors.md has the values).
class WorthLevels {
 public:
  static constexpr std::size_t kCount = 6;
  static constexpr double kWorthOfFew = 0.35;
  /// The same level as in set_up_rows() (render/visibility/pixel_row_kernel.h).
  static int of(double worth);
  /// The limit of level k: pixels of at most this worth have a level above k.
  static double limit(std::size_t k);

  /// Squared distances from the centre of the micro-image of a microlens at which levels change.
  struct Rings {
    std::array<double, kCount> squares{};  ///< the level rises by one at each [m^2]
    int at(double distance2) const {
      int level = 0;
      for (const double square : squares) level += distance2 > square ? 1 : 0;
      return level;
    }
  };
  /// @param half half of the side of a pixel [m]
  WorthLevels(const PupilTable& table, double half);
  /// @param h distance of the microlens from the optical axis [m]
  Rings at(double h) const;

 private:
  double per_step_;
  std::vector<Rings> nodes_;
};

}  // namespace plenoflame
