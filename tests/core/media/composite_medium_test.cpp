#include <limits>
#include <string>

#include "core/media/field_medium.h"
#include "core/media/layered_reference.h"
#include "core/media/ray_list.h"
#include "plenoflame/base/error.h"
#include "plenoflame/media/layered_medium.h"
#include "plenoflame/media/voxel_medium.h"
#include "support/approx.h"

namespace plenoflame::composite_medium_test {
namespace {

using test::Generator;
using test::RayList;

constexpr double kInf = std::numeric_limits<double>::infinity();

EllipsoidLayer sphere(double x, double radius, double temperature, double absorption) {
  return {{x, 0, 0}, {radius, radius, radius}, temperature, absorption};
}

std::unique_ptr<Medium> single(const EllipsoidLayer& layer, const RigidTransform& place = {}) {
  return make_layered_medium({layer}, place,
                             {SourceFunction::total(), SourceFunction::band(650e-9, 10e-9)});
}

template <class... Media>
std::shared_ptr<const Medium> composite(Media... media) {
  std::vector<std::shared_ptr<const Medium>> list;
  (list.push_back(std::move(media)), ...);
  return make_composite_medium(std::move(list));
}

TEST(CompositeMedium, OneIsItself) {
  auto one = single(sphere(0, 1, 1500, 1));
  const Medium* address = one.get();
  EXPECT_EQ(composite(std::move(one)).get(), address);
  EXPECT_THROW(make_composite_medium({}), InputError);
}

TEST(CompositeMedium, RefusesDifferentChannels) {
  auto other = make_layered_medium({sphere(0, 1, 1500, 1)}, {}, {SourceFunction::total()});
  EXPECT_THROW(composite(single(sphere(0, 1, 1500, 1)), std::move(other)), InputError);
}

// Apart from each other: the same as the layers of one medium, from every side.
template <class Real>
void check_disjoint(double tolerance) {
  const EllipsoidLayer a = sphere(-0.02, 0.015, 1500, 20), b = sphere(0.02, 0.018, 1900, 50),
                       c = sphere(0.06, 0.015, 1200, 90);
  const auto three = composite(single(c), single(a), single(b));
  const auto whole = make_layered_medium(
      {a, b, c}, {}, {SourceFunction::total(), SourceFunction::band(650e-9, 10e-9)});
  Generator g(1);
  RayList<Real> rays({0.01, 0, 0});
  for (int i = 0; i < 1000; ++i) {
    const Vec3 direction =
        i % 2 ? normalize({1, g.uniform(-.3, .3), g.uniform(-.3, .3)}) : g.direction();
    rays.add(g.point(0.02), (i % 4 < 2 ? -1 : 1) * direction, i % 5 ? -kInf : -0.01,
             i % 7 ? kInf : 0.04);
  }
  const auto composed = rays.integrate(*three), expected = rays.integrate(*whole);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    for (std::size_t k = 0; k < 2; ++k)
      EXPECT_TRUE(test::within(composed.radiance[k][i], expected.radiance[k][i], tolerance,
                               whole->source(static_cast<int>(k), 1900)))
          << i;
    EXPECT_TRUE(test::within(composed.transmittance[i], expected.transmittance[i], tolerance, 1));
  }
  // Counted by chords here and by light there: all but rays so thin that single precision sees
  // none.
  EXPECT_TRUE(test::relative(composed.counters.rays, expected.counters.rays, 0.01));
}

TEST(CompositeMedium, DisjointMediaAreComposedExactly) {
  check_disjoint<double>(1e-9);
  check_disjoint<float>(1e-5);
}

// Two spheres through each other: absorptions and emissions add in the lens between them.
template <class Real>
void check_overlap(double tolerance) {
  const SourceFunction total = SourceFunction::total();
  const double ka = 20, kb = 70, sa = total(1500), sb = total(1900);
  const auto both =
      composite(single(sphere(-0.01, 0.02, 1500, ka)), single(sphere(0.01, 0.02, 1900, kb)));
  RayList<Real> rays;
  std::vector<double> offsets;
  for (double y = 0; y < 0.0165; y += 0.0011) {
    offsets.push_back(y);
    rays.add({0, y, 0}, {1, 0, 0});
  }
  const auto r = rays.integrate(*both);
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    const double half = std::sqrt(4e-4 - offsets[i] * offsets[i]);
    // Ends: a from -0.01 - half to -0.01 + half, b from 0.01 - half to 0.01 + half.
    const double alone = 0.02, lens = 2 * half - 0.02;
    const double t1 = ka * alone, t2 = (ka + kb) * lens, t3 = kb * alone;
    const double mixed = (ka * sa + kb * sb) / (ka + kb);
    const double expected = -std::expm1(-t1) * sa - std::exp(-t1) * std::expm1(-t2) * mixed -
                            std::exp(-t1 - t2) * std::expm1(-t3) * sb;
    EXPECT_TRUE(test::relative(r.radiance[0][i], expected, tolerance)) << offsets[i];
    EXPECT_TRUE(test::relative(r.transmittance[i], std::exp(-t1 - t2 - t3), tolerance));
  }
}

TEST(CompositeMedium, OverlappingMediaAddUp) {
  check_overlap<double>(1e-11);
  check_overlap<float>(2e-6);
}

// A flame and itself at half the absorption, twice.
TEST(CompositeMedium, HalvesMakeAWhole) {
  Generator g(4);
  std::vector<EllipsoidLayer> layers, thin;
  for (int k = 0; k < 4; ++k) {
    layers.push_back({g.point(0.02),
                      {g.uniform(.01, .03), g.uniform(.01, .03), g.uniform(.01, .03)},
                      g.uniform(1000, 2000),
                      g.logarithmic(0.1, 300)});
    thin.push_back(layers.back());
    thin.back().absorption *= 0.5;
  }
  const RigidTransform place{rotation_xyz({1, 2, 3}), {5, 6, 7}};
  const std::vector<SourceFunction> total{SourceFunction::total()};
  const auto whole = make_layered_medium(layers, place, total);
  const auto halves =
      composite(make_layered_medium(thin, place, total), make_layered_medium(thin, place, total));
  RayList<double> rays(place.translation);
  for (int i = 0; i < 200; ++i) rays.add(place.translation + g.point(0.02), g.direction());
  const auto a = rays.integrate(*halves), b = rays.integrate(*whole);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    EXPECT_TRUE(test::within(a.radiance[0][i], b.radiance[0][i], 1e-9, whole->source(0, 2000)));
    EXPECT_TRUE(test::relative(a.transmittance[i], b.transmittance[i], 1e-9));
  }
}

/// A voxel flame of smooth fields with noise, absorption times `share`, and its temperature.
VoxelField voxels(double share, bool temperature, Vec3 shift) {
  VoxelField field;
  field.index_to_world.linear = {{{{1e-3, 0, 0}, {0, 1e-3, 0}, {0, 0, 1e-3}}}};
  field.index_to_world.translation = shift;
  for (int b = 0; b < 8; ++b) {
    field.brick_origins.push_back({8 * (b & 1), 8 * (b >> 1 & 1), 8 * (b >> 2)});
    for (int v = 0; v < 512; ++v) {
      const int noise = (v * 37 + b * 101) % 64;
      field.values.push_back(temperature ? 1200 + 10 * static_cast<float>(noise)
                                         : static_cast<float>(share * noise));
    }
  }
  return field;
}

// Two voxel flames in one place, merged adaptively, against one through its own kernel.
TEST(CompositeMedium, VoxelHalvesMakeAWhole) {
  const std::vector<SourceFunction> total{SourceFunction::total()};
  const auto make = [&](double share) {
    return make_voxel_medium(voxels(share, true, {}), voxels(share, false, {}),
                             VoxelInterpolation::constant, total);
  };
  const auto halves = composite(make(0.5), make(0.5));
  const auto whole = make(1);
  Generator g(8);
  RayList<double> rays({0.008, 0.008, 0.008});
  for (int i = 0; i < 100; ++i) rays.add(Vec3{0.008, 0.008, 0.008} + g.point(0.006), g.direction());
  const auto a = rays.integrate(*halves), b = rays.integrate(*whole);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    EXPECT_GT(b.radiance[0][i], 0);
    EXPECT_TRUE(test::relative(a.radiance[0][i], b.radiance[0][i], 1e-9)) << i;
    EXPECT_TRUE(test::relative(a.transmittance[i], b.transmittance[i], 1e-9)) << i;
  }
}

// A voxel flame and an ellipsoid through it, and one beside it.
TEST(CompositeMedium, VoxelsAndLayersTogether) {
  const std::vector<SourceFunction> total{SourceFunction::total()};
  const auto make = [&](Vec3 centre) {
    return composite(make_voxel_medium(voxels(1, true, {}), voxels(1, false, {}),
                                       VoxelInterpolation::trilinear, total),
                     make_layered_medium({{centre, {4e-3, 4e-3, 4e-3}, 1900, 60}}, {}, total));
  };
  Generator g(10);
  for (const double x : {0.008, 0.03}) {
    const auto both = make({x, 0.008, 0.008});
    RayList<double> rays({0.008, 0.008, 0.008});
    for (int i = 0; i < 40; ++i)
      rays.add(Vec3{0.008, 0.008, 0.008} + g.point(0.003),
               normalize({1, g.uniform(-.1, .1), g.uniform(-.1, .1)}));
    const auto r = rays.integrate(*both);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const auto expected = integrate_reference(*both, rays.ray(i), -kInf, kInf);
      EXPECT_TRUE(test::relative(r.radiance[0][i], expected[0], 2e-4)) << x << ", " << i;
      EXPECT_TRUE(test::relative(r.transmittance[i], std::exp(-expected[1]), 1e-6)) << x;
    }
  }
}

TEST(CompositeMedium, NestsAndAgreesWithTheReference) {
  const auto nested =
      composite(composite(single(sphere(0, 0.02, 1500, 30)), single(sphere(0.015, 0.02, 1900, 60))),
                single(sphere(0.09, 0.02, 1000, 10)));
  RayList<double> rays;
  Generator g(6);
  for (int i = 0; i < 50; ++i)
    rays.add(g.point(0.01), normalize({1, g.uniform(-.2, .2), g.uniform(-.2, .2)}));
  const auto r = rays.integrate(*nested);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto expected = integrate_reference(*nested, rays.ray(i), -kInf, kInf, 1e-12);
    for (std::size_t c = 0; c < 2; ++c)
      EXPECT_TRUE(test::relative(r.radiance[c][i], expected[c], 1e-10)) << i;
    EXPECT_TRUE(test::relative(r.transmittance[i], std::exp(-expected[2]), 1e-10)) << i;
  }
}

TEST(CompositeMedium, DescribesItself) {
  const auto both = composite(single(sphere(-1, 0.5, 1500, 3)), single(sphere(2, 0.25, 1900, 5)));
  const Box box = both->bounds();
  EXPECT_TRUE(test::relative(box.lower.x, -1.5, 1e-15));
  EXPECT_TRUE(test::relative(box.upper.x, 2.25, 1e-15));
  EXPECT_TRUE(test::relative(box.lower.y, -0.5, 1e-15));
  EXPECT_EQ(both->feature_size(), 0.25);
  EXPECT_EQ(both->sample({-1, 0, 0}).absorption, 3);
  EXPECT_EQ(both->sample({2, 0, 0}).temperature, 1900);
  EXPECT_EQ(both->sample({0, 0, 0}).absorption, 0);
  EXPECT_EQ(both->channel_count(), 2);
  EXPECT_NE(both->description().find("2 media"), std::string::npos);
}

TEST(CompositeMedium, NothingBadComesFromBadRays) {
  const auto both =
      composite(single(sphere(-0.01, 0.02, 1500, 20)), single(sphere(0.01, 0.02, 1900, 70)));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double bad[] = {nan, kInf, -kInf, 0, 3e38, 1e-40};
  RayList<float> rays;
  for (const double x : bad)
    for (const double y : bad) {
      rays.add({x, y, 0}, {1, 0, 0});
      rays.add({0, 0, 0}, {x, y, 0});
      rays.add({0, 0, 0}, {1, 0, 0}, x, y);
    }
  const auto r = rays.integrate(*both);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    EXPECT_TRUE(r.transmittance[i] >= 0 && r.transmittance[i] <= 1) << i;
    EXPECT_TRUE(r.radiance[0][i] >= 0 && std::isfinite(r.radiance[0][i])) << i;
  }
}

}  // namespace
}  // namespace plenoflame::composite_medium_test
