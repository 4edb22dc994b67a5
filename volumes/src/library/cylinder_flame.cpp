#include <algorithm>
#include <cmath>

#include "library/flame_builder.h"
#include "plenoflame/base/constants.h"
#include "plenoflame/volumes/flame_library.h"

namespace plenoflame {
namespace {

constexpr double kZeroCelsius = 273.15;
constexpr int kSectionLines = 32;  // through a voxel's cross-section

/// Share of the square of side 2 half around (x, y) inside of the circle. It uses exact lengths
/// along lines in the direction that crosses the circle most steeply.
double disc_share(double x, double y, double radius, double half) {
  const double r = std::hypot(x, y);
  if (r <= radius - 1.4143 * half) return 1;
  if (r >= radius + 1.4143 * half) return 0;
  const double along = std::max(std::fabs(x), std::fabs(y));
  const double across = std::min(std::fabs(x), std::fabs(y));
  double sum = 0;
  for (int i = 0; i < kSectionLines; ++i) {
    const double side = across + half * ((2 * i + 1) / double{kSectionLines} - 1);
    const double rest = radius * radius - side * side;
    if (rest <= 0) continue;
    const double reach = std::sqrt(rest);
    sum += std::max(0.0, std::min(along + half, reach) - std::max(along - half, -reach));
  }
  return sum / (kSectionLines * 2 * half);
}

}  // namespace

FlameFields make_cylinder_flame(const CylinderFlameOptions& o, const Execution& execution) {
  detail::require_between("radius", o.radius, 0, 100);
  detail::require_between("height", o.height, 0, 100);
  detail::require_between("absorption", o.absorption, 0, 1e9);
  detail::require_between("temperature swing", o.temperature_swing, -1e-300, 1e5);
  const double half = 0.5 * o.voxel_size;
  const auto absorption = [&](Vec3 p) {
    const double height = std::min(p.z + half, o.height) - std::max(p.z - half, 0.0);
    if (height <= 0) return 0.0;
    return o.absorption * disc_share(p.x, p.y, o.radius, half) * height / o.voxel_size;
  };
  const auto temperature = [&](Vec3 p) {
    const double r2 = std::min(p.x * p.x + p.y * p.y, o.radius * o.radius);
    const double z = std::clamp(p.z, 0.0, o.height);
    const double phase =
        constants::pi / (1.5 * o.height) * (r2 * o.height / (2 * o.radius * o.radius) + z);
    return kZeroCelsius + o.temperature_swing * std::max(0.0, std::sin(phase));
  };
  return detail::sample_flame({absorption, temperature},
                              {{-o.radius, -o.radius, 0}, {o.radius, o.radius, o.height}},
                              o.voxel_size, execution);
}

}  // namespace plenoflame
