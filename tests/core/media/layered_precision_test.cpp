// The single precision kernels against double precision, and what no input may bring about.
#include <cstdio>
#include <limits>
#include <string>

#include "core/media/layered_reference.h"
#include "core/media/ray_list.h"
#include "plenoflame/base/isa.h"
#include "plenoflame/media/layered_medium.h"
#include "support/approx.h"
#include "support/isas.h"

namespace plenoflame::layered_precision_test {
namespace {

using test::Generator;
using test::RayList;

constexpr double kInf = std::numeric_limits<double>::infinity();

class LayeredIsa : public ::testing::TestWithParam<Isa> {
 protected:
  void SetUp() override { options_.isa = GetParam(); }
  MediumOptions options_;
};

/// Random flames of one size; rays aimed at them, starting anywhere.
struct Flame {
  std::vector<EllipsoidLayer> layers;
  RigidTransform to_world;
  double size;

  Flame(Generator& g, int count, double thickest) : size(g.logarithmic(1e-6, 100)) {
    for (int k = 0; k < count; ++k)
      layers.push_back({g.point(0.4 * size),
                        {size * g.uniform(.2, 1), size * g.uniform(.2, 1), size * g.uniform(.2, 1)},
                        g.uniform(800, 2500),
                        g.logarithmic(1e-3, thickest) / size});
    to_world = {rotation_xyz(g.point(3)), size * g.point(1000)};
  }
  template <class Real>
  RayList<Real> rays(Generator& g, int count) const {
    RayList<Real> list(to_world.translation);
    for (int i = 0; i < count; ++i) {
      const Vec3 direction = g.direction();
      const Vec3 origin =
          to_world.translation + g.point(size) + size * g.uniform(-1, 1) * direction;
      const double near = i % 2 ? size * g.uniform(-2, 1) : -kInf;
      list.add(origin, direction, near, i % 2 ? near + size * g.uniform(0, 3) : kInf);
    }
    return list;
  }
};

/// A ray's nearness to grazing a layer: the least |1 - q.q| over the layers, q the point nearest
/// to the centre in the space where the ellipsoid is the unit sphere.
double grazing(const Flame& flame, const Ray& ray) {
  double least = 1;
  const RigidTransform to_local = flame.to_world.inverse();
  const Vec3 p = to_local.point(ray.origin), d = to_local.direction(ray.direction);
  for (const EllipsoidLayer& layer : flame.layers) {
    const Vec3 a = layer.semi_axes, c = p - layer.centre;
    const Vec3 u{c.x / a.x, c.y / a.y, c.z / a.z}, v{d.x / a.x, d.y / a.y, d.z / a.z};
    const Vec3 q = u - (dot(u, v) / dot(v, v)) * v;
    least = std::min(least, std::fabs(1 - dot(q, q)));
  }
  return least;
}

// The bound that docs/theory/emission.md states. A chord is 2 sqrt(1 - q.q): where a ray grazes a
// layer the rounding of q.q, some 1e-7 of the layer's size squared, is divided by the chord.
TEST_P(LayeredIsa, SinglePrecisionIsWithinTheDocumentedBound) {
  Generator g(11);
  double worst = 0, worst_scaled = 0, squares = 0;
  int count = 0;
  for (int f = 0; f < 60; ++f) {
    const Flame flame(g, 1 + f % 5, 5);
    const auto medium =
        make_layered_medium(flame.layers, flame.to_world, {SourceFunction::total()});
    const auto rays = flame.rays<float>(g, 1000);
    const auto single = rays.integrate(*medium, options_);
    double hottest = 0;
    for (const auto& layer : flame.layers)
      hottest = std::max(hottest, SourceFunction::total()(layer.temperature));
    RayList<double> exact_rays(flame.to_world.translation);
    std::vector<double> nearness;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Ray ray = rays.ray(i);
      exact_rays.add(ray.origin, ray.direction, rays.near(i), rays.far(i));
      nearness.push_back(grazing(flame, ray));
    }
    const auto exact = exact_rays.integrate(*medium);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const double scale = 1 / std::sqrt(std::max(nearness[i], 1e-6));
      const double error =
          std::max(std::fabs(single.radiance[0][i] - exact.radiance[0][i]) / hottest,
                   std::fabs(single.transmittance[i] - exact.transmittance[i]));
      worst = std::max(worst, error);
      worst_scaled = std::max(worst_scaled, error / scale);
      squares += error * error;
      ++count;
    }
  }
  std::printf("%s: worst %.2g, times chord %.2g, RMS %.2g of the largest source function\n",
              std::string(name(GetParam())).c_str(), worst, worst_scaled,
              std::sqrt(squares / count));
  EXPECT_LE(worst_scaled, 2e-6);
  EXPECT_LE(std::sqrt(squares / count), 5e-7);
}

TEST_P(LayeredIsa, OpticalThicknessFrom1em12To1e6) {
  const SourceFunction total = SourceFunction::total();
  for (double tau = 1e-12; tau < 2e6; tau *= 10) {
    const auto medium = make_layered_medium({{{}, {0.5, 0.5, 0.5}, 1500, tau}}, {}, {total});
    RayList<float> rays;
    rays.add({}, {0, 0, 1});
    const auto r = rays.integrate(*medium, options_);
    EXPECT_TRUE(test::relative(r.radiance[0][0], -std::expm1(-tau) * total(1500), 5e-7)) << tau;
    if (tau < 80) {
      EXPECT_TRUE(test::relative(r.transmittance[0], std::exp(-tau), 3e-7 * (1 + tau))) << tau;
    } else {
      EXPECT_EQ(r.transmittance[0], 0);
    }
  }
}

// Vertical, horizontal and axis-parallel rays, from within and from outside, tangent to the layer.
TEST_P(LayeredIsa, ZeroComponentsTangentsAndInsideStarts) {
  const SourceFunction total = SourceFunction::total();
  const double kappa = 2, source = total(1800);
  const auto medium = make_layered_medium({{{}, {1, 2, 4}, 1800, kappa}}, {}, {total});
  RayList<float> rays;
  const double semi[3] = {1, 2, 4};
  const Vec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int i = 0; i < 3; ++i) {
    rays.add({}, axes[i], 0);                                  // from the centre: one semi-axis
    rays.add({}, -axes[i], -kInf, 0);                          // up to the centre
    rays.add(0.5 * semi[i] * axes[i], axes[i], 0);             // from half way out
    rays.add(semi[(i + 1) % 3] * axes[(i + 1) % 3], axes[i]);  // tangent
  }
  const auto r = rays.integrate(*medium, options_);
  for (std::size_t i = 0; i < 3; ++i) {
    const double whole = -std::expm1(-kappa * semi[i]) * source;
    EXPECT_TRUE(test::relative(r.radiance[0][4 * i], whole, 1e-6));
    EXPECT_TRUE(test::relative(r.radiance[0][4 * i + 1], whole, 1e-6));
    EXPECT_TRUE(test::relative(r.radiance[0][4 * i + 2],
                               -std::expm1(-0.5 * kappa * semi[i]) * source, 1e-6));
    EXPECT_EQ(r.radiance[0][4 * i + 3], 0);
    EXPECT_EQ(r.transmittance[4 * i + 3], 1);
  }
}

// A camera 10 km away from a flame of 1 mm: the ray's point is near the anchor, its segment far.
TEST_P(LayeredIsa, TinyFlameFarAway) {
  const SourceFunction total = SourceFunction::total();
  const double radius = 5e-4;
  const RigidTransform far{{}, {1e4, 3, -2}};
  const auto medium =
      make_layered_medium({{{}, {radius, radius, radius}, 1800, 500}}, far, {total});
  RayList<float> rays(far.translation);
  for (int i = 0; i < 5; ++i) rays.add(far.translation + Vec3{0, i * 1e-4, 0}, {1, 0, 0}, -1e4);
  const auto r = rays.integrate(*medium, options_);
  for (std::size_t i = 0; i < 5; ++i) {
    const double chord = 2 * std::sqrt(radius * radius - 1e-8 * static_cast<double>(i * i));
    EXPECT_TRUE(test::relative(r.radiance[0][i], -std::expm1(-500 * chord) * total(1800), 2e-6));
  }
}

TEST_P(LayeredIsa, SkippingChangesNothing) {
  Generator g(21);
  for (int f = 0; f < 20; ++f) {
    const Flame flame(g, 1 + f % 4, 30);
    const auto medium =
        make_layered_medium(flame.layers, flame.to_world, {SourceFunction::total()});
    RayList<float> rays(flame.to_world.translation);
    for (int i = 0; i < 3000; ++i) {
      const double offset = flame.size * (i < 1500 ? 30 : 1);
      rays.add(flame.to_world.translation + offset * g.direction(), g.direction());
    }
    MediumOptions whole = options_;
    whole.skip = false;
    const auto a = rays.integrate(*medium, options_), b = rays.integrate(*medium, whole);
    EXPECT_EQ(a.radiance[0], b.radiance[0]);
    EXPECT_EQ(a.transmittance, b.transmittance);
    EXPECT_LE(a.counters.cells, b.counters.cells);
    EXPECT_EQ(a.counters.rays, b.counters.rays);
  }
}

// Any bits as rays: results stay finite, not negative, and a transmittance.
template <class Real>
void fuzz(const MediumOptions& options, unsigned seed) {
  Generator g(seed);
  const double specials[] = {0,     -0.0, 1,     -1,     1e-38, 1e-45,       3e38,
                             -3e38, kInf, -kInf, 1e-300, 1e300, std::nan("")};
  const auto value = [&](double scale) {
    const double u = g.uniform(0, 1);
    if (u < 0.2) return specials[static_cast<std::size_t>(g.uniform(0, 12.99))];
    return u < 0.5 ? g.uniform(-scale, scale) : g.uniform(-1, 1) * g.logarithmic(1e-20, 1e20);
  };
  for (int f = 0; f < 40; ++f) {
    std::vector<EllipsoidLayer> layers;
    for (int k = 0; k <= f % 6; ++k)
      layers.push_back(
          {g.point(g.logarithmic(1e-6, 1e6)),
           {g.logarithmic(1e-9, 1e9), g.logarithmic(1e-9, 1e9), g.logarithmic(1e-9, 1e9)},
           k == 3 ? 0 : g.logarithmic(1, 1e6),
           k == 4 ? 0 : g.logarithmic(1e-30, 1e30)});
    const auto medium =
        make_layered_medium(layers, {rotation_xyz(g.point(3)), g.point(g.logarithmic(1e-3, 1e6))},
                            {SourceFunction::total(), SourceFunction::band(300e-9, 50e-9)});
    RayList<Real> rays(g.point(g.logarithmic(1e-3, 1e6)));
    for (int i = 0; i < 1000; ++i) {
      const Vec3 direction = i % 4 ? g.direction() : Vec3{value(1), value(1), value(1)};
      rays.add({value(1), value(1), value(1)}, direction, value(10), value(10));
    }
    const auto r = rays.integrate(*medium, options);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      ASSERT_TRUE(r.transmittance[i] >= 0 && r.transmittance[i] <= 1) << f << ", ray " << i;
      for (int c = 0; c < 2; ++c)
        ASSERT_TRUE(r.radiance[c][i] >= 0 && std::isfinite(r.radiance[c][i]))
            << r.radiance[c][i] << ", flame " << f << ", ray " << i;
    }
  }
}

TEST_P(LayeredIsa, NoInputBringsAboutNanInfinityOrNegativeRadiance) {
  fuzz<float>(options_, 31);
  fuzz<float>(options_, 32);
  fuzz<double>(options_, 33);
}

INSTANTIATE_TEST_SUITE_P(Isas, LayeredIsa, ::testing::ValuesIn(test::supported_isas()),
                         [](const auto& i) { return std::string(name(i.param)); });

}  // namespace
}  // namespace plenoflame::layered_precision_test
