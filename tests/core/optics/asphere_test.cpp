// Conics and even aspheres: surfaces that are stigmatic by theory, skew rays in 40-digit
// arithmetic, and the vector kernel in single against double precision.
#include <cmath>

#include "optics/surface_kernel.h"
#include "optics/surface_kinds.h"
#include "plenoflame/base/error.h"
#include "plenoflame/optics/first_order.h"
#include "plenoflame/optics/lens_system.h"
#include "plenoflame/optics/surface_shape.h"
#include "support/approx.h"

namespace plenoflame::test::asphere_test {
namespace {

constexpr double kMm = 1e-3;

SurfaceSpec conic(double radius, double k, double index, double thickness = 0) {
  SurfaceSpec surface{radius, thickness, index, 60 * kMm, false};
  surface.conic = k;
  return surface;
}

/// The place at which a ray crosses the axis, behind the last vertex.
double crossing(const LensSystem& lens, double height) {
  Ray ray{{height, 0, 50 * kMm}, {0, 0, -1}};
  EXPECT_EQ(lens.trace_to_sensor(ray).status, RayStatus::reached);
  return lens.vertices().back() - (ray.origin.z - ray.origin.x / ray.direction.x * ray.direction.z);
}

TEST(Asphere, HyperboloidIsStigmatic) {
  // Collimated light in glass leaves a hyperboloid of conic -n^2 towards one point, at R / (n - 1).
  const double n = 1.6, r = 60 * kMm;
  const LensSystem lens({{kInfinity, 10 * kMm, n, 60 * kMm, true}, conic(-r, -n * n, 1)});
  for (const double height : {1.0, 8.0, 20.0, 29.0})
    EXPECT_TRUE(relative(crossing(lens, height * kMm), r / (n - 1), 1e-12)) << height;
}

TEST(Asphere, EllipsoidIsStigmatic) {
  // Parallel light enters an ellipsoid of conic -1/n^2 towards n R / (n - 1); a sphere around that
  // point lets it pass.
  const double n = 1.5, r = 50 * kMm, focus = n * r / (n - 1), thickness = 10 * kMm;
  SurfaceSpec front = conic(r, -1 / (n * n), n, thickness);
  const LensSystem lens({front, {focus - thickness, 0, 1, 60 * kMm, true}});
  for (const double height : {1.0, 10.0, 25.0})
    EXPECT_TRUE(relative(crossing(lens, height * kMm), focus - thickness, 1e-12)) << height;
}

struct Skew {
  Vec3 origin, direction, point, refracted;
};
// Lengths in mm; R = 80, conic -1.7, 3e-7, -4e-10, 2e-13, 0, 1e-21, from air to 1.6.
constexpr Skew kSkew[] = {
    {{12.0, -7.0, 10},
     {0.050369046006609987, 0.11081190121454197, -1},
     {12.563939090636592, -5.7593340005994976, -1.1961439683131114},
     {-0.027694308162800392, 0.095770184967056376, -0.9950181390139376}},
    {{0.0, 21.0, 10},
     {-0.20412414523193151, 0.0, -1},
     {-2.6123267102227514, 21.0, -2.7977349629783061},
     {-0.11280289596318132, -0.098050210860245552, -0.98876774968269524}},
    {{-18.0, 9.0, 10},
     {0.10540925533894598, -0.31622776601683793, -1},
     {-16.742937095616739, 5.2288112868502183, -1.9255458198726932},
     {0.14070682023306349, -0.21192395273947275, -0.96710383568424444}},
};

SurfaceSpec even_asphere() {
  SurfaceSpec surface = conic(80 * kMm, -1.7, 1.6);
  surface.aspheric = parse_aspheric("3e-7 1/mm^3, -4e-10 1/mm^5, 2e-13 1/mm^7, 0, 1e-21 1/mm^11");
  return surface;
}

TEST(Asphere, SkewRays) {
  const LensSystem lens({even_asphere()});
  for (const Skew& ray : kSkew) {
    Ray traced{kMm * ray.origin, normalize(ray.direction)};
    ASSERT_EQ(lens.trace_to_sensor(traced).status, RayStatus::reached);
    EXPECT_LT(length(traced.origin - kMm * ray.point), 1e-14 * length(kMm * ray.origin));
    EXPECT_LT(length(traced.direction - ray.refracted), 2e-14);
    // The way back.
    Ray back{traced.origin - 0.01 * traced.direction, -traced.direction};
    back.origin = traced.origin + 0.01 * traced.direction;
    ASSERT_EQ(lens.trace_to_scene(back).status, RayStatus::reached);
    EXPECT_LT(length(back.direction + normalize(ray.direction)), 3e-14);
  }
}

TEST(Asphere, BecomesTheSphere) {
  SurfaceSpec almost = conic(45 * kMm, 1e-17, 1.7, 5 * kMm);
  SurfaceSpec sphere = almost;
  sphere.conic = 0;
  for (const double height : {3.0, 17.0, 29.0}) {
    Ray a{{height * kMm, 2 * kMm, 10 * kMm}, normalize({-0.1, 0.05, -1})}, b = a;
    LensSystem({almost}).trace_to_sensor(a);
    LensSystem({sphere}).trace_to_sensor(b);
    EXPECT_LT(length(a.origin - b.origin), 1e-15);
    EXPECT_LT(length(a.direction - b.direction), 1e-14);
  }
}

TEST(Asphere, SinglePrecisionFollowsDouble) {
  const SurfaceSpec surface = even_asphere();
  const auto trace = [&](auto real, const Skew& ray, double out[6]) {
    using Real = decltype(real);
    const double mu = 1 / 1.6;
    const KernelSurface<Real> kernel{Real(0), Real(1 / 0.08), Real(9e-4), Real(mu),
                                     Real(1 - mu * mu)};
    const KernelShape<Real> shape = kernel_shape<Real>(surface, false);
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

TEST(Asphere, Statuses) {
  // An ellipsoid that ends at 20 mm.
  SurfaceSpec closed = conic(20 * kMm, 0.0, 1.5);
  closed.conic = 0.5;
  EXPECT_TRUE(relative(greatest_height(closed), 20 * kMm / std::sqrt(1.5), 1e-14));
  EXPECT_TRUE(std::isinf(greatest_height(conic(20 * kMm, -1, 1.5))));
  Ray beyond{{19 * kMm, 0, 30 * kMm}, {0, 0, -1}};
  EXPECT_EQ(LensSystem({closed}).trace_to_sensor(beyond).status, RayStatus::missed);
  closed.diameter = 10 * kMm;
  Ray wide{{6 * kMm, 0, 30 * kMm}, {0, 0, -1}};
  EXPECT_EQ(LensSystem({closed}).trace_to_sensor(wide).status, RayStatus::vignetted);
  Ray aside{{0, 6 * kMm, 30 * kMm}, {0, 0, -1}};
  EXPECT_EQ(LensSystem({closed}).trace_to_sensor(aside).status, RayStatus::vignetted);
  // Out of glass, steeper than the critical angle.
  SurfaceSpec exit = conic(-20 * kMm, -0.3, 1);
  const LensSystem total({{kInfinity, 15 * kMm, 1.8, 60 * kMm, true}, exit});
  Ray steep{{18 * kMm, 0, 30 * kMm}, {0, 0, -1}};
  EXPECT_EQ(total.trace_to_sensor(steep).status, RayStatus::total_internal_reflection);
}

TEST(Asphere, RaysThatMeetNothingOrTheBack) {
  // The paraboloid z = -x^2 / 80 (mm, along the light) and a ray that crosses z = 0 at x = 10,
  // inwards with the slope s: x^2 - 80 s x + 800 s = 0 has roots for s > 1/2 only.
  const LensSystem paraboloid({conic(-40 * kMm, -1, 1.5)});
  const auto status = [](const LensSystem& lens, double x, double slope) {
    const Vec3 direction = normalize(Vec3{-1, 0, -slope});
    Ray ray{Vec3{x * kMm, 0, 0} - 0.05 * direction, direction};
    return lens.trace_to_sensor(ray).status;
  };
  EXPECT_EQ(status(paraboloid, 10, 0.6), RayStatus::reached);
  for (const double slope : {0.45, 0.4, 0.35, 0.3, 0.25, 0.2})
    EXPECT_EQ(status(paraboloid, 10, slope), RayStatus::missed) << slope;
  // z = x^2 / 100 - x^4 / 40000 falls again beyond 14 mm: from there a flat ray inwards leaves the
  // glass, at 19.1 mm, before it ever entered.
  SurfaceSpec wave = conic(50 * kMm, -1, 1.5);
  wave.aspheric = parse_aspheric("-2.5e-5 1/mm^3");
  EXPECT_EQ(status(LensSystem({wave}), 20.5, 0.2), RayStatus::missed);
  EXPECT_EQ(status(LensSystem({wave}), 8, 0.2), RayStatus::reached);
}

TEST(Asphere, Text) {
  const auto terms = parse_aspheric("1.2e-7 1/mm^3, 0, -3E-12 1/mm^7");
  ASSERT_EQ(terms.size(), 3u);
  EXPECT_EQ(terms[0], 120.0);
  EXPECT_EQ(terms[1], 0.0);
  EXPECT_EQ(terms[2], -3e9);
  EXPECT_EQ(parse_aspheric(format_aspheric(terms)), terms);
  EXPECT_TRUE(parse_aspheric("").empty());
  EXPECT_TRUE(parse_aspheric("0, 0").empty());
  EXPECT_THROW(parse_aspheric("1e-7"), InputError);
  EXPECT_THROW(parse_aspheric("1e-7 1/mm^5"), InputError);
  EXPECT_THROW(parse_aspheric("x 1/mm^3"), InputError);
  EXPECT_THROW(parse_aspheric("1 1/m^3,"), InputError);
  EXPECT_THROW(parse_aspheric("0,0,0,0,0,0,0,0"), InputError);
}

TEST(Asphere, EveryTermCounts) {
  // A plane with one term: 1 mm of sag at 10 mm; parallel rays meet it at sag (h / 10 mm)^n.
  for (int i = 0; i < 7; ++i) {
    SurfaceSpec surface{kInfinity, 0, 1.5, 60 * kMm, false};
    surface.aspheric.assign(static_cast<std::size_t>(i), 0.0);
    surface.aspheric.push_back(1 * kMm / std::pow(10 * kMm, 4 + 2 * i));
    for (const double height : {10.0, 9.0}) {
      Ray ray{{0, height * kMm, 20 * kMm}, {0, 0, -1}};
      ASSERT_EQ(LensSystem({surface}).trace_to_sensor(ray).status, RayStatus::reached);
      EXPECT_TRUE(relative(ray.origin.z, -kMm * std::pow(height / 10, 4 + 2 * i), 1e-11)) << i;
    }
  }
}

TEST(Asphere, SagIsTheSurface) {
  // 40 digits: the skew rays' points lie on it.
  for (const Skew& ray : kSkew)
    EXPECT_TRUE(relative(surface_sag(even_asphere(), kMm * Vec2{ray.point.x, ray.point.y}),
                         -kMm * ray.point.z, 1e-13));
}

}  // namespace
}  // namespace plenoflame::test::asphere_test
