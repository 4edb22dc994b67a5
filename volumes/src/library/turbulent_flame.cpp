#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "library/flame_builder.h"
#include "plenoflame/volumes/flame_library.h"

namespace plenoflame {
namespace {

constexpr double kStoichiometric = 0.35;  // xi of the hottest mixture
constexpr double kSootCentre = 0.55;      // xi of the densest soot
constexpr double kSootWidth = 0.25;       // half width in xi, compact support
constexpr double kRichTemperature = 0.6;  // of the peak's rise above ambient, at xi = 1
constexpr double kDisplacement = 0.35;    // of an octave's scale
constexpr double kFluctuation = 0.5;      // of xi, in the largest octave

/// SplitMix64 (Steele, Lea, Flood 2014).
std::uint64_t mix(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

std::uint64_t hash(std::uint64_t seed, int i, int j, int k) {
  std::uint64_t h = mix(seed ^ static_cast<std::uint32_t>(i));
  h = mix(h ^ static_cast<std::uint32_t>(j));
  return mix(h ^ static_cast<std::uint32_t>(k));
}

/// Four independent gradient noises (Perlin 2002: quintic blend, twelve edge directions), from one
/// hash per lattice point. They are 0 on average, within about -1 and 1, with features of size 1.
std::array<double, 4> noise(std::uint64_t seed, Vec3 p) {
  const double cell[3] = {std::floor(p.x), std::floor(p.y), std::floor(p.z)};
  const double f[3] = {p.x - cell[0], p.y - cell[1], p.z - cell[2]};
  double blend[3];
  for (int a = 0; a < 3; ++a) blend[a] = f[a] * f[a] * f[a] * (f[a] * (f[a] * 6 - 15) + 10);
  std::array<double, 4> sum{};
  for (int corner = 0; corner < 8; ++corner) {
    const int c[3] = {corner & 1, corner >> 1 & 1, corner >> 2};
    const std::uint64_t h =
        hash(seed, static_cast<int>(cell[0]) + c[0], static_cast<int>(cell[1]) + c[1],
             static_cast<int>(cell[2]) + c[2]);
    const double d[3] = {f[0] - c[0], f[1] - c[1], f[2] - c[2]};
    double weight = 1;
    for (int axis = 0; axis < 3; ++axis) weight *= c[axis] != 0 ? blend[axis] : 1 - blend[axis];
    for (std::size_t n = 0; n < 4; ++n) {
      const std::uint64_t bits = h >> (16 * n);
      const auto zero =
          static_cast<int>((bits & 0x3fff) % 3);  // the edge has no part along this axis
      const double a = d[(zero + 1) % 3], b = d[(zero + 2) % 3];
      sum[n] += weight * (((bits >> 14 & 1) != 0 ? a : -a) + ((bits >> 15 & 1) != 0 ? b : -b));
    }
  }
  return sum;
}

struct Octave {
  double scale;      // [m]
  double amplitude;  // of the fluctuation of xi
  std::uint64_t seed;
};

class Plume {
 public:
  explicit Plume(const TurbulentFlameOptions& options) : o_(options) {
    const double largest = 2 * (o_.base_radius + o_.spread * o_.height / 2);
    std::uint64_t number = 0;
    for (double scale = largest; scale >= o_.smallest_scale; scale /= 2) {
      octaves_.push_back({scale, kFluctuation * o_.intensity * std::cbrt(scale / largest),
                          mix(mix(o_.seed) + ++number)});
      displacement_ += kDisplacement * o_.intensity * scale;
    }
  }

  /// Mixture fraction, 0 to 1.
  double mixture(Vec3 p) const {
    const double z = p.z;
    if (z <= 0 || z >= o_.height) return 0;
    // Soot needs xi above kSootCentre - kSootWidth: nothing is left where even the displaced point
    // is outside of the plume. The bound holds for the temperature's sake a bit further out.
    if (std::hypot(p.x, p.y) > reach(z)) return 0;
    Vec3 moved = p;
    double fluctuation = 1;
    const double grown = std::min(1.0, z / (4 * o_.base_radius));  // calm at the nozzle
    for (const Octave& octave : octaves_) {
      const Vec3 q = (1 / octave.scale) * p;
      const double step = kDisplacement * o_.intensity * grown * octave.scale;
      const std::array<double, 4> n = noise(octave.seed, q);
      moved = moved + step * Vec3{n[0], n[1], n[2]};
      fluctuation += grown * octave.amplitude * n[3];
    }
    const double u = std::clamp(moved.z / o_.height, 0.0, 1.0);
    const double r = std::hypot(moved.x, moved.y) / width(std::max(moved.z, 0.0));
    const double mean = (1 - u) * std::exp(-r * r);
    const double ends = std::min({1.0, z / o_.base_radius, (o_.height - z) / o_.base_radius});
    return std::clamp(mean * fluctuation * ends, 0.0, 1.0);
  }

  double absorption(Vec3 p) const {
    const double x = (mixture(p) - kSootCentre) / kSootWidth;
    return std::fabs(x) < 1 ? o_.peak_absorption * (1 - x * x) * (1 - x * x) : 0;
  }

  double temperature(Vec3 p) const {
    const double xi = mixture(p);
    const double rise = xi < kStoichiometric ? xi / kStoichiometric
                                             : 1 - (1 - kRichTemperature) * (xi - kStoichiometric) /
                                                       (1 - kStoichiometric);
    return kAmbientTemperature + (o_.peak_temperature - kAmbientTemperature) * rise;
  }

  Box bounds() const {
    const double r = reach(o_.height);
    return {{-r, -r, 0}, {r, r, o_.height}};
  }

 private:
  /// Radius beyond which xi counts as 0. The noise's RMS is a third of its bound, so that a
  /// displacement of more than half of the bound does not occur.
  double reach(double z) const { return 1.6 * width(z + displacement_ / 2) + displacement_ / 2; }
  double width(double z) const { return o_.base_radius + o_.spread * z; }

  TurbulentFlameOptions o_;
  std::vector<Octave> octaves_;
  double displacement_ = 0;  // [m] the largest possible along one axis
};

}  // namespace

FlameFields make_turbulent_flame(const TurbulentFlameOptions& o, const Execution& execution) {
  using detail::require_between;
  require_between("height", o.height, 0, 100);
  require_between("base radius", o.base_radius, 0, 100);
  require_between("spread", o.spread, -1e-300, 10);
  require_between("smallest scale", o.smallest_scale, o.height * 1e-5, 100);
  require_between("intensity", o.intensity, -1e-300, 10);
  require_between("peak absorption", o.peak_absorption, 0, 1e9);
  require_between("peak temperature", o.peak_temperature, kAmbientTemperature, 1e5);
  const Plume plume(o);
  return detail::sample_flame(
      {[&](Vec3 p) { return plume.absorption(p); }, [&](Vec3 p) { return plume.temperature(p); }},
      plume.bounds(), o.voxel_size, execution);
}

}  // namespace plenoflame
