// Voxel grids where they are hardest, against an integrator of its own (long double, adaptive,
// samples in a map) and closed forms.
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "core/media_voxel/voxel_fixture.h"
#include "plenoflame/base/error.h"
#include "plenoflame/media/voxel_medium.h"
#include "stress/stress_table.h"

namespace plenoflame::voxel_stress_test {
namespace {

using test::StressCase;
using test::text;

constexpr const char* kArea = "Voxel grids";
constexpr const char* kReference = "adaptive quadrature, long double";
constexpr int kSide = 10;

/// A number in [0, 1) that depends on the place only.
float noise(int i, int j, int k) {
  std::uint32_t h = static_cast<std::uint32_t>(i) * 0x9E3779B1u ^
                    static_cast<std::uint32_t>(j) * 0x85EBCA77u ^
                    static_cast<std::uint32_t>(k) * 0xC2B2AE3Du;
  h = (h ^ (h >> 15)) * 0x2C1B3C6Du;
  h = (h ^ (h >> 12)) * 0x297A2D39u;
  return static_cast<float>((h ^ (h >> 15)) >> 8) * 0x1p-24f;
}

/// The noise's variation from sample to sample.
struct Strength {
  double coldest = 1700, hottest = 1700.1;  ///< [K]
  double per_voxel = 0.01;                  ///< optical thickness of a cell at most
};
/// So mild that the method's own error (docs/theory/emission.md) does not hide what geometry and
/// rounding do.
constexpr Strength kMild{};
/// Flame against air from one sample to the next, and cells that are half opaque.
constexpr Strength kHarsh{400, 2400, 1};

/// Noise of 10^3 samples.
struct Fields {
  VoxelField temperature, absorption;
  std::unique_ptr<Medium> medium;
  Strength strength;
  explicit Fields(const AffineTransform& place, const Strength& noise_of = kMild,
                  const VoxelMediumOptions& options = {})
      : Fields(place, place, noise_of, options) {}
  /// @param temperature_place lattice of the temperature, of its own
  Fields(const AffineTransform& temperature_place, const AffineTransform& place,
         const Strength& noise_of, const VoxelMediumOptions& options)
      : strength(noise_of) {
    // Absorption per metre such that a step of one index is 0 to per_voxel optically.
    const double step = std::cbrt(
        std::fabs(dot(place.linear.rows[0], cross(place.linear.rows[1], place.linear.rows[2]))));
    const auto scale = static_cast<float>(strength.per_voxel / step);
    const auto coldest = static_cast<float>(strength.coldest);
    const auto span = static_cast<float>(strength.hottest - strength.coldest);
    const std::array<int, 3> low{0, 0, 0}, high{kSide, kSide, kSide};
    temperature = test::make_field(
        low, high, [=](int i, int j, int k) { return coldest + span * noise(i, j, k); },
        temperature_place, coldest);
    absorption = test::make_field(
        low, high, [=](int i, int j, int k) { return scale * noise(k + 31, i, j); }, place);
    medium = make_voxel_medium(temperature, absorption, VoxelInterpolation::trilinear,
                               {SourceFunction::total()}, options);
  }
};

Vec3 column(const AffineTransform& t, int c) {
  const auto& r = t.linear.rows;
  return c == 0   ? Vec3{r[0].x, r[1].x, r[2].x}
         : c == 1 ? Vec3{r[0].y, r[1].y, r[2].y}
                  : Vec3{r[0].z, r[1].z, r[2].z};
}

/// The line through an index point along an index direction.
Ray line(const AffineTransform& t, Vec3 index, Vec3 along) {
  const Vec3 d = along.x * column(t, 0) + along.y * column(t, 1) + along.z * column(t, 2);
  return {t.point(index), normalize(d)};
}

/// Error over the radiance, or where that is smaller over what a ray across all cells at their
/// hottest and thickest would show.
template <class Real>
void check(StressCase& radiance, const Fields& fields, const std::vector<Ray>& rays,
           const std::string& where, const RaySpan& span = {-1e3, 1e3}, Vec3 anchor = {}) {
  const double most =
      static_cast<double>(test::total_source(static_cast<long double>(fields.strength.hottest))) *
      -std::expm1(-fields.strength.per_voxel * kSide);
  std::vector<test::Seen> seen;
  for (const Isa isa : test::supported_isas())
    seen.push_back(
        test::see<Real>(*fields.medium, rays, test::with(isa), span.near, span.far, anchor));
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const test::Reference exact = test::integrate_voxels(
        {fields.temperature, fields.absorption, VoxelInterpolation::trilinear}, rays[i], span,
        test::total_source);
    for (const test::Seen& s : seen)
      radiance.add((s.radiance[0][i] - static_cast<double>(exact.radiance)) /
                       std::max(most, static_cast<double>(exact.radiance)),
                   where + ", ray " + std::to_string(i));
  }
}

/// Along faces, edges and corners of cells, with one or two zero components.
std::vector<Ray> special_rays(const AffineTransform& t) {
  std::vector<Ray> rays;
  const Vec3 axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, -1}};
  const Vec3 places[] = {{4, 4, 4},         {4.5, 4, 4}, {4.5, 4.25, 4},
                         {4.5, 4.25, 4.75}, {8, 8, 8},   {0, 3, 5}};
  for (const Vec3 axis : axes)
    for (const Vec3 place : places) rays.push_back(line(t, place, axis));
  for (const Vec3 diagonal :
       {Vec3{1, 1, 0}, Vec3{0, -1, 1}, Vec3{1, 0, 1}, Vec3{1, 1, 1}, Vec3{-1, 1, 1}, Vec3{2, 1, 0},
        Vec3{1, 1e-9, 0}, Vec3{1, 1e-5, -1e-5}})
    for (const Vec3 place : {Vec3{4, 4, 4}, Vec3{4.5, 4.5, 4}, Vec3{8, 7, 8}})
      rays.push_back(line(t, place, diagonal));
  return rays;
}

template <class Real>
void faces(const std::string& precision, double bound) {
  StressCase radiance(
      kArea, "rays along faces, edges, corners, with zero components, " + precision + " [radiance]",
      kReference, bound);
  const Fields fields(test::scaled(0.5));
  check<Real>(radiance, fields, special_rays(test::scaled(0.5)), "noise");
}

TEST(VoxelStress, FacesEdgesCorners) {
  faces<float>("single", 5e-6);
  faces<double>("double", 1e-6);
}

template <class Real>
void harsh(const std::string& precision, double tolerance, double bound) {
  StressCase radiance(kArea,
                      "noise of 400 to 2400 K and tau 0 to 1 from sample to sample, " +
                          text("tolerance", tolerance) + ", " + precision + " [radiance]",
                      kReference, bound);
  const Fields fields(test::scaled(0.5), kHarsh, {tolerance});
  check<Real>(radiance, fields, special_rays(test::scaled(0.5)), "noise");
}

/// The same with temperatures on a lattice that is turned and shifted against that of absorption.
void harsh_apart(double tolerance, double bound) {
  StressCase radiance(kArea,
                      "the same noise, temperature on a turned lattice, " +
                          text("tolerance", tolerance) + ", double [radiance]",
                      kReference, bound);
  AffineTransform turned = test::scaled(0.5);
  turned.linear = rotation_xyz({0.1, -0.2, 0.15}) * turned.linear;
  turned.translation = {0.13, -0.21, 0.07};
  const Fields fields(turned, test::scaled(0.5), kHarsh, {tolerance});
  check<double>(radiance, fields, special_rays(test::scaled(0.5)), "noise");
}

TEST(VoxelStress, HarshNoise) {
  // The method's own error, which follows VoxelMediumOptions::tolerance: that is a share of the
  // emission of the brightest of 8^3 cells, and a ray may stay in dim ones.
  harsh<float>("single", 3e-4, 4e-3);
  harsh<double>("double", 3e-4, 4e-3);
  harsh<double>("double", 3e-5, 6e-4);
  harsh<double>("double", 1e-7, 3e-5);
  harsh_apart(3e-4, 4e-3);
}

template <class Real>
void inside(const std::string& precision, double bound) {
  StressCase radiance(kArea, "rays that start or end inside, " + precision + " [radiance]",
                      kReference, bound);
  const AffineTransform t = test::scaled(0.5);
  const Fields fields(t);
  const std::vector<Ray> rays = special_rays(t);
  for (const double start : {0.0, 1e-9, 0.25, 1.0})
    check<Real>(radiance, fields, {rays.begin(), rays.begin() + 24}, text("from", start),
                {start, start + 1.3});
}

TEST(VoxelStress, StartsInside) {
  inside<float>("single", 5e-6);
  inside<double>("double", 1e-6);
}

AffineTransform shape(const std::string& name) {
  AffineTransform t = test::scaled(0.01);
  const auto diagonal = [](double x, double y, double z) {
    return Mat3{{{{x, 0, 0}, {0, y, 0}, {0, 0, z}}}};
  };
  const Mat3 turn = rotation_xyz({0, 0, std::acos(-1.0) / 4});
  if (name == "aspect 1e3") t.linear = diagonal(1e-5, 1e-2, 1e-2);
  if (name == "aspect 1e-3") t.linear = diagonal(1e-2, 1e-5, 1e-5);
  if (name == "rotated by 45 degrees") t.linear = turn * t.linear;
  if (name == "aspect 1e3, rotated") t.linear = turn * diagonal(1e-2, 1e-5, 1e-2);
  if (name == "mirrored and sheared")
    t.linear = {{{{-0.01, 0.004, 0}, {0, 0.01, -0.003}, {0.002, 0, 0.01}}}};
  if (name == "moved by 1e6 voxels") t.translation = {1e4, -1e4, 1e4};
  return t;
}

template <class Real>
void shapes(const std::string& precision, double bound) {
  StressCase radiance(
      kArea,
      "voxels of aspect 1e-3 and 1e3, rotated by 45 degrees, sheared, moved by 1e6 voxels, " +
          precision + " [radiance]",
      kReference, bound);
  for (const char* name : {"aspect 1e3", "aspect 1e-3", "rotated by 45 degrees",
                           "aspect 1e3, rotated", "mirrored and sheared", "moved by 1e6 voxels"}) {
    const AffineTransform t = shape(name);
    const Fields fields(t);
    std::vector<Ray> rays;
    for (const Vec3 along :
         {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}, Vec3{1, 1, 0}, Vec3{0.3, -0.7, 0.9}})
      for (const Vec3 at : {Vec3{4.5, 4.5, 4.5}, Vec3{2.3, 7.1, 3.8}})
        rays.push_back(line(t, at, along));
    check<Real>(radiance, fields, rays, name, {-1e6, 1e6}, t.point({4.5, 4.5, 4.5}));
  }
}

TEST(VoxelStress, Shapes) {
  // Single precision knows places to 1e-7 of the box's diagonal, which a voxel 1000 times as thin
  // as the others feels as 1e-4 of itself.
  shapes<float>("single", 3e-5);
  shapes<double>("double", 1e-6);
}

template <class Real>
void sizes(const std::string& precision, double bound) {
  StressCase radiance(kArea,
                      "grids of 1 um to 100 m at 1 mm to 10 km, " + precision + " [radiance]",
                      kReference, bound);
  for (double size = 1e-6; size < 101; size *= 100)
    for (const double away : {1e-3, 1.0, 1e4}) {
      AffineTransform t = test::scaled(size / kSide);
      t.translation = {away, 0.1 * away, 0};
      const Fields fields(t);
      const std::vector<Ray> rays{line(t, {4.4, 4.7, 5.2}, {1, 0.2, -0.1}),
                                  line(t, {1.4, 6.7, 3.3}, {1, 0, 0})};
      check<Real>(radiance, fields, rays, text("size", size) + text(" m at", away) + " m",
                  {-1e3 * size, 1e3 * size}, t.point({4.5, 4.5, 4.5}));
    }
}

TEST(VoxelStress, Sizes) {
  sizes<float>("single", 1e-5);
  // A double holds a place at 10 km to 2e-12 m: a micrometre of flame to 2e-6.
  sizes<double>("double", 1e-5);
}

// A uniform grid: radiance S (1 - e^-tau) in closed form, in one cell and in 1e5 cells.
template <class Real>
void thickness(const std::string& precision, double bound) {
  StressCase one(kArea, "one row of 3 cells, tau 1e-12 to 1e6, " + precision + " [relative]",
                 "closed form", bound);
  for (double tau = 1e-12; tau < 1.01e6; tau *= 10) {
    const AffineTransform t = test::scaled(1);
    const auto kappa = static_cast<float>(tau);
    const VoxelField temperature = test::make_field(
        {0, 0, 0}, {4, 4, 4}, [](int, int, int) { return 1700.f; }, t, 1700);
    const VoxelField absorption = test::make_field(
        {0, 0, 0}, {4, 4, 4}, [=](int, int, int) { return kappa; }, t);
    const auto medium = make_voxel_medium(temperature, absorption, VoxelInterpolation::trilinear,
                                          {SourceFunction::total()});
    // From the middle of the second cell over one index: constant absorption all the way.
    const std::vector<Ray> rays{{{1, 1.5, 1.5}, {1, 0, 0}}};
    for (const Isa isa : test::supported_isas()) {
      const test::Seen seen = test::see<Real>(*medium, rays, test::with(isa), 0, 1);
      const long double exact =
          -expm1l(-static_cast<long double>(kappa)) * test::total_source(1700);
      one.add(static_cast<double>(seen.radiance[0][0] / exact - 1), text("tau =", tau));
    }
  }
  StressCase many(kArea, "1e5 cells in a row, tau 1e-12 to 1e6, " + precision + " [relative]",
                  "closed form", (sizeof(Real) == 4 ? 3000 : 300) * bound);
  constexpr int cells = 100000;
  // Single precision adds 1e5 roundings of the transmittance up.
  const AffineTransform t = test::scaled(1);
  const VoxelField temperature = test::make_field(
      {0, 0, 0}, {cells + 1, 2, 2}, [](int, int, int) { return 1700.f; }, t, 1700);
  for (const double tau : {1e-12, 1e-6, 1e-2, 1.0, 1e6}) {
    const auto kappa = static_cast<float>(tau / cells);
    const VoxelField absorption = test::make_field(
        {0, 0, 0}, {cells + 1, 2, 2}, [=](int, int, int) { return kappa; }, t);
    const auto medium = make_voxel_medium(temperature, absorption, VoxelInterpolation::trilinear,
                                          {SourceFunction::total()});
    // No skipping: every cell is stepped through.
    const test::Seen seen = test::see<Real>(*medium, {{{0, 0.5, 0.5}, {1, 0, 0}}},
                                            test::with(best_isa(), false), 0, cells, {});
    const long double exact =
        -expm1l(-static_cast<long double>(kappa) * cells) * test::total_source(1700);
    many.add(static_cast<double>(seen.radiance[0][0] / exact - 1), text("tau =", tau));
  }
}

TEST(VoxelStress, OpticalThickness) {
  thickness<float>("single", 1e-6);
  thickness<double>("double", 1e-14);
}

/// A smooth flame in a cube of 16 mm, places in metres from its corner.
struct SmoothFlame {
  double thickness;  ///< optical, across the cube, about
  static constexpr double kWide = 0.016;
  double temperature(Vec3 p) const {
    return 1500 + 300 * std::sin(250 * p.x) * std::cos(150 * p.y + 1) + 2e4 * p.z;
  }
  double absorption(Vec3 p) const {
    return thickness / kWide * (1 + 0.5 * std::cos(200 * p.x - 120 * p.z) * std::sin(180 * p.y));
  }
};

/// Radiance at the start of a line by the transfer equation dL/ds = kappa (L - S), backwards from
/// the end (Runge-Kutta of fourth order; 4000 steps leave 1e-13).
long double by_transfer_equation(const SmoothFlame& flame, const Ray& ray, double length) {
  constexpr int kSteps = 4000;
  const long double h = static_cast<long double>(length) / kSteps;
  const auto slope = [&](long double s, long double radiance) {
    const Vec3 p = ray.at(static_cast<double>(s));
    const auto t = static_cast<long double>(flame.temperature(p));
    return static_cast<long double>(flame.absorption(p)) * (test::total_source(t) - radiance);
  };
  long double radiance = 0;
  for (int i = 0; i < kSteps; ++i) {
    const long double s = static_cast<long double>(length) - h * i;
    const long double a = slope(s, radiance), b = slope(s - h / 2, radiance + h / 2 * a);
    const long double c = slope(s - h / 2, radiance + h / 2 * b),
                      d = slope(s - h, radiance + h * c);
    radiance += h / 6 * (a + 2 * b + 2 * c + d);
  }
  return radiance;
}

// Two errors of a grid: that of the quadrature, of fourth order in the spacing, and that of knowing
// the flame at its samples only, of second order (docs/theory/emission.md). Prints
//   order | thickness | spacing [m] | error of the quadrature | error of the grid
TEST(VoxelStress, ErrorAgainstSpacing) {
  for (const double thickness : {0.1, 1.0, 10.0}) {
    const SmoothFlame flame{thickness};
    std::vector<double> quadrature, whole;
    for (int n = 4; n <= 64; n *= 2) {
      const double spacing = SmoothFlame::kWide / n;
      const AffineTransform place = test::scaled(spacing);
      const auto at = [&](int i, int j, int k) {
        return place.point({double(i), double(j), double(k)});
      };
      const VoxelField temperature = test::make_field(
          {0, 0, 0}, {n + 1, n + 1, n + 1},
          [&](int i, int j, int k) { return static_cast<float>(flame.temperature(at(i, j, k))); },
          place, 300);
      const VoxelField absorption = test::make_field(
          {0, 0, 0}, {n + 1, n + 1, n + 1},
          [&](int i, int j, int k) { return static_cast<float>(flame.absorption(at(i, j, k))); },
          place);
      const auto medium = make_voxel_medium(temperature, absorption, VoxelInterpolation::trilinear,
                                            {SourceFunction::total()}, {0});
      double of_quadrature = 0, of_grid = 0;
      constexpr int kRays = 5;
      for (int r = 0; r < kRays; ++r) {
        const Vec3 from{0.001, 0.003 + 0.002 * r, 0.0021}, to{0.015, 0.0128 - 0.0014 * r, 0.0141};
        const double length = plenoflame::length(to - from);
        const Ray ray{from, normalize(to - from)};
        const test::Seen seen =
            test::see<double>(*medium, {ray}, test::with(Isa::baseline, false), 0, length);
        const test::Reference own =
            test::integrate_voxels({temperature, absorption, VoxelInterpolation::trilinear}, ray,
                                   {0, length}, test::total_source);
        const double exact = static_cast<double>(by_transfer_equation(flame, ray, length));
        const double trilinear = static_cast<double>(own.radiance);
        of_quadrature += std::pow(seen.radiance[0][0] / trilinear - 1, 2) / kRays;
        of_grid += std::pow(seen.radiance[0][0] / exact - 1, 2) / kRays;
      }
      quadrature.push_back(std::sqrt(of_quadrature));
      whole.push_back(std::sqrt(of_grid));
      std::printf("order | %g | %.6g | %.4g | %.4g\n", thickness, spacing, quadrature.back(),
                  whole.back());
    }
    // Over the last two halvings before rounding (samples are floats) is felt.
    EXPECT_GT(std::log2(quadrature[2] / quadrature[4]) / 2, 3.7) << thickness;
    EXPECT_GT(std::log2(whole[2] / whole[4]) / 2, 1.9) << thickness;
    EXPECT_LT(std::log2(whole[2] / whole[4]) / 2, 2.2) << thickness;
  }
}

// Results that no grid, transform or ray may bring about, counted.
TEST(VoxelStress, RandomGridsAndRays) {
  StressCase bad(
      kArea, "NaN, infinite or negative results of 2e4 random rays, any bits, random grids [count]",
      "none", 0);
  std::mt19937_64 random(7);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const auto logarithmic = [&](double low, double high) {
    return std::exp(uniform(std::log(low), std::log(high)));
  };
  const auto bits = [&] {
    return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(random())));
  };
  double wrong = 0;
  for (int grid = 0; grid < 40; ++grid) {
    AffineTransform t;
    for (Vec3& row : t.linear.rows)
      row = {uniform(-1, 1) * logarithmic(1e-4, 1e2), uniform(-1, 1) * logarithmic(1e-4, 1e2),
             uniform(-1, 1) * logarithmic(1e-4, 1e2)};
    t.translation = {uniform(-1e3, 1e3), uniform(-10, 10), uniform(-1e6, 1e6)};
    const double most = logarithmic(1e-12, 1e12), cold = uniform(0, 3000), span = uniform(0, 1e5);
    const bool sparse = grid % 3 == 0;
    const VoxelField temperature = test::make_field(
        {-9, 0, 3}, {8, 12, 9},
        [&](int i, int j, int k) {
          return static_cast<float>(cold + span * static_cast<double>(noise(i, j, k)));
        },
        t, static_cast<float>(cold));
    const VoxelField absorption = test::make_field(
        {-9, 0, 3}, {8, 12, 9},
        [&](int i, int j, int k) {
          const float n = noise(k, j, i);
          return sparse && n < 0.9f ? 0.f : static_cast<float>(most * static_cast<double>(n));
        },
        t);
    std::unique_ptr<Medium> medium;
    try {
      medium =
          make_voxel_medium(temperature, absorption,
                            grid % 2 ? VoxelInterpolation::constant : VoxelInterpolation::trilinear,
                            {SourceFunction::total(), SourceFunction::band(650e-9, 10e-9)});
    } catch (const InputError&) {
      continue;  // a transform that cannot be inverted
    }
    std::vector<Ray> rays;
    for (int i = 0; i < 500; ++i) {
      const Vec3 target = t.point({uniform(-10, 10), uniform(-1, 13), uniform(2, 10)});
      const Vec3 d = normalize({uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)});
      rays.push_back(i % 3 == 0   ? Ray{{bits(), bits(), bits()}, {bits(), bits(), bits()}}
                     : i % 3 == 1 ? Ray{{bits(), bits(), bits()}, d}
                                  : Ray{target, d});
    }
    for (const Isa isa : test::supported_isas())
      for (const bool skip : {true, false}) {
        const test::Seen seen =
            test::see<float>(*medium, rays, test::with(isa, skip), grid % 4 ? -1e30 : bits(),
                             grid % 4 ? 1e30 : bits());
        for (std::size_t i = 0; i < rays.size(); ++i) {
          wrong += !(seen.transmittance[i] >= 0 && seen.transmittance[i] <= 1);
          for (int c = 0; c < 2; ++c)
            wrong += !(seen.radiance[static_cast<std::size_t>(c)][i] >= 0 &&
                       std::isfinite(seen.radiance[static_cast<std::size_t>(c)][i]));
        }
      }
  }
  bad.add(wrong, "-");
}

}  // namespace
}  // namespace plenoflame::voxel_stress_test
