// Biconic surfaces: skew rays in 50-digit arithmetic, cylinders by paraxial optics, and what they
// become where both sections are alike.
#include <cmath>

#include "optics/surface_kernel.h"
#include "optics/surface_kinds.h"
#include "plenoflame/optics/first_order.h"
#include "plenoflame/optics/lens_system.h"
#include "plenoflame/optics/surface_shape.h"
#include "support/approx.h"

namespace plenoflame::test::biconic_test {
namespace {

constexpr double kMm = 1e-3;

SurfaceSpec biconic(double radius_x, double conic_x, double radius_y, double conic_y, double index,
                    double thickness = 0) {
  SurfaceSpec surface{kInfinity, thickness, index, 60 * kMm, false};
  surface.radius_x = radius_x, surface.radius_y = radius_y;
  surface.conic_x = conic_x, surface.conic_y = conic_y;
  return surface;
}

struct Skew {
  Vec3 origin, direction, point, refracted;
};
// Lengths in mm; radii 80 and -140, conics -1.7 and 0.6, from air to 1.6: the crossing by secants,
// the normal by numerical differentiation, Snell's law as vectors, all with 50 digits.
constexpr Skew kSkew[] = {
    {{12.0, -7.0, 10.0},
     {0.0496389487360315858, 0.109205687219269489, -0.992778974720631717},
     {12.5429913826301758, -5.80541895821361318, -0.859827652603516586},
     {-0.0277670292593228986, 0.0527222009669961619, -0.99822310212262047}},
    {{0.0, 21.0, 10.0},
     {-0.196116135138184032, 0.0, -0.98058067569092016},
     {-1.68572252263203868, 21.0, 1.57138738683980662},
     {-0.114460117618554326, 0.057872385842077453, -0.991740726415776687}},
    {{-18.0, 9.0, 10.0},
     {0.0953462589245592315, -0.286038776773677695, -0.953462589245592315},
     {-16.8348581460920818, 5.5045744382762454, -1.65141853907918199},
     {0.138585690435926739, -0.164047146651921055, -0.976669104703205297}},
    {{15.0, 15.0, 10.0},
     {0.019607843137254902, -0.19607843137254902, -0.980392156862745098},
     {15.2171391307178981, 12.828608692821019, -0.856956535894905048},
     {-0.0598444755042174097, -0.0878559787191947263, -0.994333930706841325}},
};

SurfaceSpec saddle() {
  return biconic(80 * kMm, -1.7, -140 * kMm, 0.6, 1.6);
}

TEST(Biconic, SkewRays) {
  const LensSystem lens({saddle()});
  for (const Skew& ray : kSkew) {
    Ray traced{kMm * ray.origin, normalize(ray.direction)};
    ASSERT_EQ(lens.trace_to_sensor(traced).status, RayStatus::reached);
    EXPECT_LT(length(traced.origin - kMm * ray.point), 1e-14 * length(kMm * ray.origin));
    EXPECT_LT(length(traced.direction - ray.refracted), 2e-14);
    // The way back.
    Ray back{traced.origin + 0.01 * traced.direction, -traced.direction};
    ASSERT_EQ(lens.trace_to_scene(back).status, RayStatus::reached);
    EXPECT_LT(length(back.origin - kMm * ray.point), 1e-14 * length(kMm * ray.origin));
    EXPECT_LT(length(back.direction + normalize(ray.direction)), 3e-14);
  }
}

TEST(Biconic, SagIsTheSurface) {
  for (const Skew& ray : kSkew)
    EXPECT_TRUE(within(surface_sag(saddle(), kMm * Vec2{ray.point.x, ray.point.y}),
                       -kMm * ray.point.z, 1e-14, 2 * kMm));
}

TEST(Biconic, SinglePrecisionFollowsDouble) {
  const auto trace = [&](auto real, const Skew& ray, double out[6]) {
    using Real = decltype(real);
    const double mu = 1 / 1.6;
    const KernelSurface<Real> kernel{Real(0), Real(0), Real(9e-4), Real(mu), Real(1 - mu * mu)};
    const KernelShape<Real> shape = kernel_shape<Real>(saddle(), false);
    const Vec3 d = normalize(ray.direction);
    Real x = Real(kMm * ray.origin.x), y = Real(kMm * ray.origin.y), z = Real(-kMm * ray.origin.z);
    Real dx = Real(d.x), dy = Real(d.y), dz = Real(-d.z);
    int code = 0;
    scalar::refract_at_shape(kernel, shape, 0, x, y, z, dx, dy, dz, code);
    EXPECT_EQ(code, 0);
    const Real values[] = {x, y, z, dx, dy, dz};
    for (int i = 0; i < 6; ++i) out[i] = static_cast<double>(values[i]);
  };
  for (const Skew& ray : kSkew) {
    double single[6], exact[6];
    trace(0.0f, ray, single);
    trace(0.0, ray, exact);
    // Positions to 2 units in the last place of the height, directions of one.
    for (int i = 0; i < 3; ++i) EXPECT_TRUE(within(single[i], exact[i], 4e-7, 0.03));
    for (int i = 3; i < 6; ++i) EXPECT_TRUE(within(single[i], exact[i], 4e-7, 1));
  }
}

// With equal sections it is the conic, in other operations.
TEST(Biconic, EqualSectionsMakeTheConic) {
  for (const double k : {0.0, -1.7, 0.4}) {
    SurfaceSpec round{45 * kMm, 5 * kMm, 1.7, 60 * kMm, false};
    round.conic = k;
    const SurfaceSpec same = biconic(45 * kMm, k, 45 * kMm, k, 1.7, 5 * kMm);
    EXPECT_TRUE(relative(greatest_height(same), greatest_height(round), 1e-15));
    EXPECT_TRUE(relative(paraxial_radius(same), 45 * kMm, 1e-15));
    for (const double height : {0.0, 3.0, 17.0, 29.0}) {
      Ray a{{height * kMm, 2 * kMm, 10 * kMm}, normalize({-0.1, 0.05, -1})}, b = a;
      ASSERT_EQ(LensSystem({same}).trace_to_sensor(a).status, RayStatus::reached);
      ASSERT_EQ(LensSystem({round}).trace_to_sensor(b).status, RayStatus::reached);
      // Some units in the last place of the height, and of a unit vector.
      EXPECT_LT(length(a.origin - b.origin), 8 * 2.2e-16 * 30 * kMm) << k << " " << height;
      EXPECT_LT(length(a.direction - b.direction), 16 * 2.2e-16) << k << " " << height;
    }
  }
}

/// Distance behind the last vertex at which a ray that enters parallel to the axis crosses the
/// plane x = 0 (y = 0).
double crossing(const LensSystem& lens, Vec2 start) {
  Ray ray{{start.x, start.y, 50 * kMm}, {0, 0, -1}};
  EXPECT_EQ(lens.trace_to_sensor(ray).status, RayStatus::reached);
  const double way =
      start.y == 0 ? -ray.origin.x / ray.direction.x : -ray.origin.y / ray.direction.y;
  return lens.vertices().back() - (ray.origin.z + way * ray.direction.z);
}

// A plano-cylinder of radius R has a focal line R / (n - 1) - t / n behind its plane face; rays in
// its other section go straight on. A lens of two radii has two focal lines.
TEST(Biconic, CylindersHaveFocalLines) {
  const double n = 1.5, r = 52 * kMm, t = 4 * kMm, narrow = 1e-4 * r;
  const auto lens = [&](double radius_x, double radius_y) {
    return LensSystem({biconic(radius_x, 0, radius_y, 0, n, t), {kInfinity, 0, 1, 0.06, true}});
  };
  const double line = r / (n - 1) - t / n;
  // The paraxial error is of the order of (h / R)^2.
  EXPECT_TRUE(relative(crossing(lens(r, kInfinity), {narrow, 0}), line, 1e-7));
  EXPECT_TRUE(relative(crossing(lens(kInfinity, r), {0, narrow}), line, 1e-7));
  EXPECT_TRUE(relative(crossing(lens(r, 1.5 * r), {0, narrow}), 1.5 * r / (n - 1) - t / n, 1e-7));
  Ray along{{0, 7 * kMm, 50 * kMm}, {0, 0, -1}};
  ASSERT_EQ(lens(r, kInfinity).trace_to_sensor(along).status, RayStatus::reached);
  EXPECT_EQ(along.direction.y, 0);
  EXPECT_EQ(along.origin.y, 7 * kMm);
  // First-order optics takes the mean power: half of a cylinder's.
  EXPECT_TRUE(
      relative(first_order(lens(r, kInfinity).surfaces()).focal_length, 2 * r / (n - 1), 1e-12));
}

// By theory a hyperbolic cylinder of conic -n^2 has a sharp focal line for all heights.
TEST(Biconic, HyperbolicCylinderIsStigmatic) {
  const double n = 1.6, r = 60 * kMm;
  const LensSystem lens(
      {{kInfinity, 10 * kMm, n, 60 * kMm, true}, biconic(-r, -n * n, kInfinity, 0, 1)});
  for (const double height : {1.0, 8.0, 20.0, 29.0})
    EXPECT_TRUE(relative(crossing(lens, {height * kMm, 0}), r / (n - 1), 1e-12)) << height;
}

TEST(Biconic, Statuses) {
  // Along y an ellipse that ends at 20 mm / sqrt(1.5).
  SurfaceSpec closed = biconic(kInfinity, 0, 20 * kMm, 0.5, 1.5);
  EXPECT_TRUE(relative(greatest_height(closed), 20 * kMm / std::sqrt(1.5), 1e-14));
  Ray beyond{{0, 19 * kMm, 30 * kMm}, {0, 0, -1}}, along{{19 * kMm, 0, 30 * kMm}, {0, 0, -1}};
  EXPECT_EQ(LensSystem({closed}).trace_to_sensor(beyond).status, RayStatus::missed);
  EXPECT_EQ(LensSystem({closed}).trace_to_sensor(along).status, RayStatus::reached);
  closed.diameter = 10 * kMm;
  Ray wide{{6 * kMm, 0, 30 * kMm}, {0, 0, -1}};
  EXPECT_EQ(LensSystem({closed}).trace_to_sensor(wide).status, RayStatus::vignetted);
  const LensSystem total(
      {{kInfinity, 15 * kMm, 1.8, 60 * kMm, true}, biconic(kInfinity, 0, -20 * kMm, -0.3, 1)});
  Ray steep{{0, 18 * kMm, 30 * kMm}, {0, 0, -1}};
  EXPECT_EQ(total.trace_to_sensor(steep).status, RayStatus::total_internal_reflection);
}

TEST(Biconic, WhatItIs) {
  EXPECT_FALSE(is_round(saddle()));
  EXPECT_TRUE(is_aspheric(saddle()));
  EXPECT_EQ(radii_in_words(biconic(40 * kMm, 0, kInfinity, 0, 1.5)), "x 40 mm, y inf");
  // The saddle's edge along y lies in front of its vertex: h^2 / (2 R) to leading order.
  const double h = 30 * kMm, c = 1 / (140 * kMm);
  EXPECT_TRUE(relative(reach_to_scene(saddle()),
                       c * h * h / (1 + std::sqrt(1 - 1.6 * c * c * h * h)), 1e-12));
  MainLensSpec lens;
  lens.surfaces = {saddle()};
  const MainLensSpec round = round_counterpart(lens);
  EXPECT_TRUE(is_round(round));
  EXPECT_TRUE(relative(first_order(round.surfaces).focal_length,
                       first_order(lens.surfaces).focal_length, 1e-14));
}

TEST(Biconic, WhatCannotBe) {
  const auto key = [](const SurfaceSpec& surface) {
    const auto fault = surface_fault(surface);
    return fault ? fault->key : "";
  };
  EXPECT_EQ(key(saddle()), "");
  SurfaceSpec surface = saddle();
  surface.radius_y = 0;
  EXPECT_EQ(key(surface), "radius_y");
  surface = saddle();
  surface.radius = 0.1;
  EXPECT_EQ(key(surface), "radius");
  surface = saddle();
  surface.aspheric = {1};
  EXPECT_EQ(key(surface), "aspheric");
  surface = saddle();
  surface.conic_x = 5;
  surface.diameter = 70 * kMm;
  EXPECT_EQ(key(surface), "diameter");
}

}  // namespace
}  // namespace plenoflame::test::biconic_test
