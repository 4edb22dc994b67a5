#include "render/forward/forward_pixels.h"

#include <cmath>
#include <numbers>

#include "plenoflame/sampling/philox.h"

namespace plenoflame {
namespace {

constexpr std::uint64_t kBlurSeed = 0x626c7572u;  ///< independent of the bundles' numbers
constexpr std::uint64_t kMostDraws = 64;          ///< one draw in 8000 is repeated

}  // namespace

/// A point of the Gaussian, in pixels, by the Box-Muller method; a point beyond the cut is drawn
/// again.
Vec2 ForwardPixels::blurred(std::int64_t bundle, std::uint64_t number) const {
  constexpr double kCut = SensorSpec::kBlurCut;
  for (std::uint64_t draw = 0; draw < kMostDraws; ++draw) {
    const auto bits =
        philox(seed_ ^ kBlurSeed, static_cast<std::uint64_t>(bundle), kMostDraws * number + draw);
    const double radius = std::sqrt(-2 * std::log(unit_uniform(bits[0], bits[1])));
    const double turn = 2 * std::numbers::pi * unit_uniform(bits[2], bits[3]);
    const Vec2 point{radius * std::cos(turn), radius * std::sin(turn)};
    if (std::fabs(point.x) <= kCut && std::fabs(point.y) <= kCut)
      return camera_.spec().sensor.blur * point;
  }
  return {};
}

std::optional<ForwardPixels::Place> ForwardPixels::find(Vec2 sensor_point, std::int64_t bundle,
                                                        std::uint64_t number,
                                                        double& reached) const {
  const SensorSpec& sensor = camera_.spec().sensor;
  auto [x, y] = camera_.image_point(sensor_point);
  if (sensor.blur > 0) {
    const Vec2 beside = blurred(bundle, number);
    x += beside.x;
    y += beside.y;
  }
  if (!(x >= 0 && x < sensor.columns && y >= 0 && y < sensor.rows)) return std::nullopt;
  reached += 1;
  const int column = static_cast<int>(x), row = static_cast<int>(y);
  if (column < window_.x || column >= window_.x + window_.width || row < window_.y ||
      row >= window_.y + window_.height)
    return std::nullopt;
  return Place{column, row};
}

}  // namespace plenoflame
