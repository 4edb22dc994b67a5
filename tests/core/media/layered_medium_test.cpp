#include "plenoflame/media/layered_medium.h"

#include <limits>
#include <string>

#include "core/media/layered_reference.h"
#include "core/media/ray_list.h"
#include "plenoflame/base/constants.h"
#include "plenoflame/base/error.h"
#include "support/approx.h"

namespace plenoflame::layered_medium_test {
namespace {

using test::Generator;
using test::RayList;

constexpr double kInf = std::numeric_limits<double>::infinity();
const RigidTransform kIdentity;

/// The default layered flame: core, luminous zone and outer zone [m, K, 1/m].
std::vector<EllipsoidLayer> default_layers() {
  return {{{0, 0, 0.014}, {0.004, 0.004, 0.012}, 1200, 1.0},
          {{0, 0, 0.022}, {0.007, 0.007, 0.022}, 1650, 30.0},
          {{0, 0, 0.029}, {0.010, 0.010, 0.030}, 1900, 1.5}};
}

EllipsoidLayer sphere(double radius, double temperature, double absorption, Vec3 centre = {}) {
  return {centre, {radius, radius, radius}, temperature, absorption};
}

// Concentric circular sections of 10, 7 and 4 mm: spectral radiance at 650 nm along chords at an
// offset b (mpmath, 40 digits; nine of them are in the literature of the project).
TEST(LayeredMedium, ChordRadiances) {
  const double width = 1e-15;  // so narrow that the band is Planck's function times its width
  const auto medium =
      make_layered_medium({sphere(4e-3, 1200, 1), sphere(7e-3, 1650, 30), sphere(10e-3, 1900, 1.5)},
                          kIdentity, {SourceFunction::band(650e-9, width)});
  const struct {
    double offset, radiance, transmittance;
  } rows[] = {{0, 323664716.66384759467, 0.82119063331265791907},
              {3e-3, 378485006.46512349243, 0.79004588473876479231},
              {5e-3, 475615184.37354646296, 0.73695931430252053478},
              {8e-3, 159660261.24096199749, 0.982161032358300718}};
  RayList<double> rays;
  for (const auto& row : rows) rays.add({-0.3, row.offset, 0}, {1, 0, 0});
  const auto results = rays.integrate(*medium);
  for (std::size_t i = 0; i < std::size(rows); ++i) {
    EXPECT_TRUE(test::relative(results.radiance[0][i] / width, rows[i].radiance, 1e-11));
    EXPECT_TRUE(test::relative(results.transmittance[i], rows[i].transmittance, 1e-14));
  }
}

TEST(LayeredMedium, HomogeneousChord) {
  const SourceFunction total = SourceFunction::total();
  for (const double kappa : {1e-9, 1.0, 400.0, 1e8}) {
    const auto medium = make_layered_medium({sphere(0.02, 1700, kappa)}, kIdentity, {total});
    RayList<double> rays;
    for (int i = 0; i < 100; ++i) rays.add({0, 2e-4 * i, 0.5}, {0, 0, -1});
    const auto results = rays.integrate(*medium);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const double b = 2e-4 * static_cast<double>(i);
      const double tau = 2 * kappa * std::sqrt((0.02 - b) * (0.02 + b));
      EXPECT_TRUE(test::relative(results.radiance[0][i], -std::expm1(-tau) * total(1700), 1e-13));
      EXPECT_TRUE(test::relative(results.transmittance[i], std::exp(-tau), 1e-13 * (1 + tau)) ||
                  tau > 700);
    }
  }
}

// Emissivity of an isothermal sphere, 1 - 2/t^2 (1 - (1 + t) e^-t) with t = 2 kappa R: the mean of
// 1 - e^-tau over the cross-section, by Simpson's rule in mu^2 = 1 - (b/R)^2.
TEST(LayeredMedium, IsothermalSphere) {
  const double expected[][2] = {{.01, .00664173}, {.1, .06423197}, {.5, .27836792}, {1, .47151776},
                                {2, .70300292},   {5, .92323421},  {10, .98000999}};
  const SourceFunction total = SourceFunction::total();
  const double radius = 0.03;
  for (const auto& [t, emissivity] : expected) {
    const auto medium =
        make_layered_medium({sphere(radius, 1500, t / (2 * radius))}, kIdentity, {total});
    const int n = 400;
    RayList<double> rays;
    for (int i = 0; i <= n; ++i) {
      const double mu = static_cast<double>(i) / n;
      rays.add({radius * std::sqrt((1 - mu) * (1 + mu)), -1, 0}, {0, 1, 0});
    }
    const auto results = rays.integrate(*medium);
    double sum = 0;
    for (int i = 0; i <= n; ++i) {
      const int weight = i == 0 || i == n ? 1 : i % 2 == 1 ? 4 : 2;
      const double mu = static_cast<double>(i) / n;
      sum += weight * 2 * mu * results.radiance[0][static_cast<std::size_t>(i)] / total(1500);
    }
    EXPECT_TRUE(test::within(sum / (3 * n), emissivity, 6e-9, 1)) << t;  // as printed
    const double formula = 1 - 2 / (t * t) * (1 - (1 + t) * std::exp(-t));
    EXPECT_TRUE(test::relative(sum / (3 * n), formula, 1e-9)) << t;
  }
}

// A very flat ellipsoid seen face on is a slab: 1 - e^-tau, and its hemispherical emissivity
// 1 - 2 E3(tau) follows from slanted rays of path 1/mu.
TEST(LayeredMedium, IsothermalSlab) {
  const double expected[][2] = {{.1, .16742}, {.5, .55679}, {1, .78062}, {2, .93973}};
  const SourceFunction total = SourceFunction::total();
  const double half = 0.005;
  for (const auto& [tau, emissivity] : expected) {
    const auto medium =
        make_layered_medium({{{}, {1e5, 1e5, half}, 1800, tau / (2 * half)}}, kIdentity, {total});
    const int n = 2000;
    RayList<double> rays;
    for (int i = 1; i <= n; ++i) {
      const double mu = static_cast<double>(i) / n;
      rays.add({}, {std::sqrt((1 - mu) * (1 + mu)), 0, mu});
    }
    const auto results = rays.integrate(*medium);
    double sum = 0;
    for (int i = 1; i <= n; ++i) {
      const int weight = i == n ? 1 : i % 2 == 1 ? 4 : 2;
      sum += weight * 2.0 * i / n * results.radiance[0][static_cast<std::size_t>(i - 1)];
    }
    EXPECT_TRUE(test::relative(sum / (3 * n) / total(1800), emissivity, 3e-5)) << tau;
    EXPECT_TRUE(test::relative(results.radiance[0].back() / total(1800), -std::expm1(-tau), 1e-13));
  }
}

/// A flame of random misaligned layers, overlapping at will, and rays through it.
struct RandomCase {
  std::vector<EllipsoidLayer> layers;
  RigidTransform to_world;
  Vec3 anchor;
  struct Line {
    Vec3 origin, direction;
    double near, far;
  };
  std::vector<Line> lines;

  RandomCase(unsigned seed, int layer_count, int ray_count, double thickest) {
    Generator g(seed);
    const double size = g.logarithmic(1e-6, 100);
    for (int k = 0; k < layer_count; ++k)
      layers.push_back(
          {g.point(0.5 * size),
           {size * g.uniform(0.2, 1), size * g.uniform(0.2, 1), size * g.uniform(0.2, 1)},
           g.uniform(800, 2500),
           g.logarithmic(1e-3, thickest) / size});
    to_world = {rotation_xyz(g.point(3)), size * g.point(100)};
    anchor = to_world.translation + g.point(0.2 * size);
    for (int i = 0; i < ray_count; ++i) {
      const Vec3 target = to_world.translation + g.point(size);
      const Vec3 direction = g.direction();
      const Vec3 origin = target + size * g.uniform(-1, 1) * direction;
      const bool bounded = i % 3 == 0;
      const double near = bounded ? size * g.uniform(-2, 1) : -kInf;
      lines.push_back({origin, direction, near, bounded ? near + size * g.uniform(-0.1, 2) : kInf});
    }
  }
  std::unique_ptr<Medium> medium() const {
    return make_layered_medium(layers, to_world, {SourceFunction::total()});
  }
  template <class Real>
  RayList<Real> rays() const {
    RayList<Real> list(anchor);
    for (const Line& line : lines) list.add(line.origin, line.direction, line.near, line.far);
    return list;
  }
  double hottest() const {
    double t = 0;
    for (const EllipsoidLayer& layer : layers) t = std::max(t, layer.temperature);
    return SourceFunction::total()(t);
  }
};

TEST(LayeredMedium, OverlappingLayersAgreeWithTheDefinition) {
  for (int layers = 1; layers <= 11; ++layers) {
    const RandomCase random(static_cast<unsigned>(layers), layers, 500, 30);
    const auto rays = random.rays<double>();
    const auto results = rays.integrate(*random.medium());
    int hits = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const auto expected =
          test::layered_reference(random.layers, random.to_world, SourceFunction::total(),
                                  rays.ray(i), random.lines[i].near, random.lines[i].far);
      hits += expected.radiance > 0;
      // Tangent rays: a chord is the root of a difference, so it has half the digits.
      EXPECT_TRUE(test::within(results.radiance[0][i], static_cast<double>(expected.radiance), 1e-9,
                               random.hottest()))
          << layers << " layers, ray " << i;
      EXPECT_TRUE(test::within(results.transmittance[i],
                               static_cast<double>(expected.transmittance), 1e-9, 1));
    }
    EXPECT_GT(hits, 20);
  }
}

TEST(LayeredMedium, AgreesWithTheReferenceIntegrator) {
  const RandomCase random(77, 4, 60, 30);
  const auto medium = random.medium();
  const auto rays = random.rays<double>();
  const auto results = rays.integrate(*medium);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto expected =
        integrate_reference(*medium, rays.ray(i), random.lines[i].near, random.lines[i].far);
    EXPECT_TRUE(test::relative(results.radiance[0][i], expected[0], 1e-9)) << i;
    EXPECT_TRUE(test::relative(results.transmittance[i], std::exp(-expected[1]), 1e-9)) << i;
  }
}

TEST(LayeredMedium, FirstListedWins) {
  const SourceFunction total = SourceFunction::total();
  const EllipsoidLayer cold = sphere(0.01, 1000, 5), hot = sphere(0.01, 2000, 5);
  for (const auto& layers : {std::vector{cold, hot}, std::vector{hot, cold}}) {
    const auto medium = make_layered_medium(layers, kIdentity, {total});
    RayList<double> rays;
    rays.add({}, {0, 0, 1});
    EXPECT_TRUE(test::relative(rays.integrate(*medium).radiance[0][0],
                               -std::expm1(-0.1) * total(layers[0].temperature), 1e-14));
    EXPECT_EQ(medium->sample({0.001, 0, 0}).temperature, layers[0].temperature);
  }
}

// The same flame through the path without sorting and the one with it (a layer that no ray meets
// keeps the others from being nested).
TEST(LayeredMedium, NestedAndOverlappingPathsAgree) {
  auto layers = default_layers();
  const auto nested = make_layered_medium(layers, kIdentity, {SourceFunction::total()});
  layers.insert(layers.begin(), sphere(0.001, 3000, 1, {0.05, 0.05, 0}));
  const auto sorted = make_layered_medium(layers, kIdentity, {SourceFunction::total()});
  EXPECT_NE(nested->description().find("nested"), std::string::npos);
  EXPECT_NE(sorted->description().find("overlapping"), std::string::npos);
  Generator g(5);
  RayList<double> rays({0, 0, 0.03});
  for (int i = 0; i < 5000; ++i) {
    const double y = g.uniform(-0.011, 0.011), z = g.uniform(-0.002, 0.06);
    rays.add({0, y, z}, normalize({1, g.uniform(-.1, .1), g.uniform(-.1, .1)}));
  }
  const auto a = rays.integrate(*nested), b = rays.integrate(*sorted);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    EXPECT_TRUE(
        test::within(a.radiance[0][i], b.radiance[0][i], 1e-10, SourceFunction::total()(1900)));
    EXPECT_TRUE(test::relative(a.transmittance[i], b.transmittance[i], 1e-10));
  }
}

TEST(LayeredMedium, NestingIsNeverClaimedWrongly) {
  Generator g(9);
  int nested = 0;
  for (int i = 0; i < 2000; ++i) {
    const EllipsoidLayer inner{
        g.point(0.4), {g.uniform(.1, .6), g.uniform(.1, .6), g.uniform(.1, .6)}, 1500, 1};
    const EllipsoidLayer outer{{}, {g.uniform(.5, 1), g.uniform(.5, 1), g.uniform(.5, 1)}, 1500, 1};
    const auto medium = make_layered_medium({inner, outer}, kIdentity, {SourceFunction::total()});
    const bool claimed = medium->description().find("nested") != std::string::npos;
    double farthest = 0;  // of points on the inner surface, in the outer's unit space
    for (int k = 0; k < 4000; ++k) {
      const Vec3 u = g.direction();
      const Vec3 p{(inner.centre.x + inner.semi_axes.x * u.x) / outer.semi_axes.x,
                   (inner.centre.y + inner.semi_axes.y * u.y) / outer.semi_axes.y,
                   (inner.centre.z + inner.semi_axes.z * u.z) / outer.semi_axes.z};
      farthest = std::max(farthest, dot(p, p));
    }
    nested += claimed;
    EXPECT_TRUE(!claimed || farthest <= 1 + 1e-12) << i << ", " << farthest;
    EXPECT_TRUE(claimed || farthest >= 0.98) << i << ", " << farthest;
  }
  EXPECT_GT(nested, 100);
}

TEST(LayeredMedium, MissesAreExact) {
  const auto medium = make_layered_medium(default_layers(), kIdentity, {SourceFunction::total()});
  for (const bool skip : {true, false}) {
    RayList<float> rays;
    for (int i = 0; i < 200; ++i) rays.add({0, 0.0101 + 1e-3 * i, 0.03}, {1, 0, 0});
    rays.add({0, 0, 0.03}, {1, 0, 0});              // one hit, so that the block is not left out
    rays.add({0, 0, 0.03}, {1, 0, 0}, 0.02, kInf);  // behind the flame
    rays.add({0, 0, 0.03}, {1, 0, 0}, -kInf, -0.02);
    rays.add({0, 0, 0.03}, {1, 0, 0}, 0.001, -0.001);  // ends before it starts
    MediumOptions options;
    options.skip = skip;
    const auto results = rays.integrate(*medium, options);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (i == 200) {
        EXPECT_GT(results.radiance[0][i], 0);
        continue;
      }
      EXPECT_EQ(results.radiance[0][i], 0) << i;
      EXPECT_EQ(results.transmittance[i], 1) << i;
    }
  }
}

TEST(LayeredMedium, SegmentsAddUp) {
  const auto medium = make_layered_medium(default_layers(), kIdentity, {SourceFunction::total()});
  RayList<double> rays;
  const Vec3 direction = normalize({1, 0.1, -0.2});
  for (const double cut : {-0.009, -0.002, 0.0, 0.004, 0.02}) {
    rays.add({0, 0, 0.02}, direction);
    rays.add({0, 0, 0.02}, direction, -kInf, cut);
    rays.add({0, 0, 0.02}, direction, cut, kInf);
  }
  const auto r = rays.integrate(*medium);
  for (std::size_t i = 0; i < rays.size(); i += 3) {
    EXPECT_TRUE(test::relative(r.radiance[0][i + 1] + r.transmittance[i + 1] * r.radiance[0][i + 2],
                               r.radiance[0][i], 1e-12));
    EXPECT_TRUE(
        test::relative(r.transmittance[i + 1] * r.transmittance[i + 2], r.transmittance[i], 1e-13));
  }
}

TEST(LayeredMedium, ChannelsShareTheGeometryAndNothingElse) {
  const std::vector<SourceFunction> channels{SourceFunction::total(),
                                             SourceFunction::band(650e-9, 10e-9),
                                             SourceFunction::band(532e-9, 10e-9)};
  const auto all = make_layered_medium(default_layers(), kIdentity, channels);
  Generator g(3);
  RayList<float> rays({0, 0, 0.03});
  for (int i = 0; i < 1500; ++i)
    rays.add({0, g.uniform(-.01, .01), g.uniform(0, .06)}, g.direction());
  const auto together = rays.integrate(*all);
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const auto one = make_layered_medium(default_layers(), kIdentity, {channels[c]});
    const auto alone = rays.integrate(*one);
    EXPECT_EQ(alone.radiance[0], together.radiance[c]);
    EXPECT_EQ(alone.transmittance, together.transmittance);
  }
}

TEST(LayeredMedium, DescribesItself) {
  const RigidTransform turned{rotation_xyz({0, 0, constants::pi / 2}), {1, 2, 3}};
  const auto medium = make_layered_medium({{{0.1, 0, 0}, {0.03, 0.02, 0.01}, 1500, 2}}, turned,
                                          {SourceFunction::total()});
  // The long axis now lies along y.
  const Box box = medium->bounds();
  EXPECT_TRUE(test::relative(box.lower.x, 1 - 0.02, 1e-12));
  EXPECT_TRUE(test::relative(box.upper.y, 2 + 0.1 + 0.03, 1e-12));
  EXPECT_TRUE(test::relative(box.upper.z, 3 + 0.01, 1e-12));
  EXPECT_EQ(medium->feature_size(), 0.01);
  EXPECT_EQ(medium->sample({1, 2.125, 3}).absorption, 2);
  EXPECT_EQ(medium->sample({1.03, 2.1, 3}).absorption, 0);
  std::vector<double> t;
  medium->append_breakpoints({{1, 0, 3}, {0, 1, 0}}, t);
  ASSERT_EQ(t.size(), 2u);
  EXPECT_TRUE(test::relative(t[0], 2.07, 1e-12));
  EXPECT_TRUE(test::relative(t[1], 2.13, 1e-12));
}

TEST(LayeredMedium, RefusesBadInput) {
  const SourceFunction total = SourceFunction::total();
  const auto make = [&](EllipsoidLayer layer) {
    return make_layered_medium({layer}, kIdentity, {total});
  };
  EXPECT_THROW(make_layered_medium({}, kIdentity, {total}), InputError);
  EXPECT_THROW(make_layered_medium({sphere(1, 1, 1)}, kIdentity, {}), InputError);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {-1.0, nan, kInf}) {
    EXPECT_THROW(make(sphere(bad, 1, 1)), InputError);
    EXPECT_THROW(make(sphere(1, bad, 1)), InputError);
    EXPECT_THROW(make(sphere(1, 1, bad)), InputError);
    if (bad < 0) continue;
    EXPECT_THROW(make(sphere(1, 1, 1, {0, bad, 0})), InputError);
  }
  EXPECT_THROW(make(sphere(0, 1, 1)), InputError);
  EXPECT_THROW(make(sphere(1, 1e30, 1)), InputError);
}

}  // namespace
}  // namespace plenoflame::layered_medium_test
