#include <algorithm>
#include <cmath>

#include "library/flame_builder.h"
#include "plenoflame/base/constants.h"
#include "plenoflame/volumes/flame_library.h"

namespace plenoflame {
namespace {

constexpr double kNegligible = 1e-6;  // of the largest soot volume fraction

double square(double x) {
  return x * x;
}

class SootFlame {
 public:
  explicit SootFlame(const SootFlameOptions& options)
      : o_(options),
        kappa_(soot_absorption(options.peak_volume_fraction, options.absorption_function,
                               options.wavelength)),
        p_(options.sharpness * options.peak_position / (1 - options.peak_position)) {}

  double absorption(Vec3 place) const {
    const double u = place.z / o_.height;
    if (u <= 0 || u >= 1) return 0;
    const double r = std::hypot(place.x, place.y);
    const double along = std::pow(u / o_.peak_position, p_) *
                         std::pow((1 - u) / (1 - o_.peak_position), o_.sharpness);
    const double across = std::exp(-square((r - annulus(u)) / o_.annulus_width)) +
                          o_.core_share * u * u * std::exp(-square(r / o_.core_width));
    const double share = along * across;
    return share > kNegligible ? kappa_ * share : 0;
  }

  double temperature(Vec3 place) const {
    const double u = std::clamp(place.z / o_.height, 0.0, 1.0);
    const double outside = std::hypot(place.x, place.y) - annulus(u) - o_.rim_distance;
    const double far = outside > 0 ? kAmbientTemperature
                                   : o_.core_temperature_base +
                                         u * (o_.core_temperature_tip - o_.core_temperature_base);
    const double width = outside > 0 ? o_.outer_width : o_.inner_width;
    return far + (o_.rim_temperature - far) * std::exp(-square(outside / width));
  }

  /// The line's light as a share of its peak.
  double line(Vec3 place) const {
    const double u = place.z / o_.height;
    if (u <= 0 || u >= 1) return 0;
    const double outside = std::hypot(place.x, place.y) - annulus(u) - o_.rim_distance;
    const double share = std::exp(-square(outside / o_.line_width) - square(u / o_.line_height)) *
                         -std::expm1(-10 * u / o_.line_height);
    return share > kNegligible ? share : 0;
  }

  Box bounds() const {
    // The annulus has fallen below what is kept there; the core is narrower or falls likewise.
    const double lines = o_.lines.empty() ? 0 : o_.rim_distance + 4.0 * o_.line_width;
    const double reach = std::max(4.0 * std::max(o_.annulus_width, o_.core_width), lines);
    const double widest = std::max(
        o_.base_radius, 0.25 * square(o_.base_radius + o_.bulge) / std::max(o_.bulge, 1e-12));
    const double r = (o_.bulge > o_.base_radius ? widest : o_.base_radius) + reach;
    return {{-r, -r, 0}, {r, r, o_.height}};
  }

 private:
  double annulus(double u) const { return (1 - u) * (o_.base_radius + o_.bulge * u); }

  SootFlameOptions o_;
  double kappa_;
  double p_;
};

}  // namespace

double soot_absorption(double volume_fraction, double absorption_function, double wavelength) {
  return 6 * constants::pi * absorption_function * volume_fraction / wavelength;
}

SootFlameOptions candle_flame() {
  SootFlameOptions candle;
  candle.voxel_size = 0.2e-3;
  candle.height = 32e-3;
  candle.base_radius = 1.5e-3;
  candle.bulge = 7e-3;
  candle.annulus_width = 0.8e-3;
  candle.core_width = 1.5e-3;
  candle.core_share = 1.0;
  candle.peak_volume_fraction = 3e-6;
  candle.peak_position = 0.5;
  candle.sharpness = 0.8;
  candle.rim_temperature = 1850;
  candle.core_temperature_base = 1100;
  candle.core_temperature_tip = 1650;
  candle.rim_distance = 1.2e-3;
  candle.inner_width = 2.2e-3;
  candle.outer_width = 2e-3;
  return candle;
}

SootFlameOptions diffusion_flame() {
  return {};
}

FlameFields make_soot_flame(const SootFlameOptions& o, const Execution& execution) {
  using detail::require_between;
  require_between("flame height", o.height, 0, 100);
  require_between("base radius", o.base_radius, 0, 100);
  require_between("bulge", o.bulge, -o.base_radius, 100);
  require_between("annulus width", o.annulus_width, 0, 100);
  require_between("core width", o.core_width, 0, 100);
  require_between("core share", o.core_share, -1e-300, 100);
  require_between("soot volume fraction", o.peak_volume_fraction, 0, 1);
  require_between("peak position", o.peak_position, 0, 1);
  require_between("sharpness", o.sharpness, 0, 100);
  for (const double t : {o.rim_temperature, o.core_temperature_base, o.core_temperature_tip})
    require_between("temperature", t, 0, 1e5);
  require_between("rim distance", o.rim_distance, -1e-300, 100);
  require_between("inner width", o.inner_width, 0, 100);
  require_between("outer width", o.outer_width, 0, 100);
  require_between("soot absorption function E(m)", o.absorption_function, 0,
                  std::nextafter(kGreatestSootFunction, 2));
  require_between("wavelength", o.wavelength, 1e-8, 1e-3);
  require_between("line width", o.line_width, 0, 100);
  require_between("line height", o.line_height, 0, 100);
  for (const SootFlameOptions::Line& line : o.lines)
    require_between("peak emission of a line", line.peak, 0, 1e12);
  const SootFlame flame(o);
  detail::FlameFunctions functions{[&](Vec3 p) { return flame.absorption(p); },
                                   [&](Vec3 p) { return flame.temperature(p); }};
  for (const SootFlameOptions::Line& line : o.lines)
    functions.lines.emplace_back(line.name, [&](Vec3 p) { return line.peak * flame.line(p); });
  return detail::sample_flame(functions, flame.bounds(), o.voxel_size, execution);
}

}  // namespace plenoflame
