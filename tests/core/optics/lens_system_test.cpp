#include "plenoflame/optics/lens_system.h"

#include <cmath>
#include <string>

#include "plenoflame/optics/first_order.h"
#include "prescriptions.h"
#include "reference/lens_trace.h"
#include "support/approx.h"

namespace plenoflame::test::lens_system_test {
namespace {

struct AxisCrossing {
  double longitudinal;  ///< behind the paraxial focus [m]
  double transverse;    ///< height in the paraxial focal plane [m]
};

/// A ray parallel to the axis at a height, from the scene.
AxisCrossing axial_ray(const std::vector<SurfaceSpec>& surfaces, double height) {
  const LensSystem lens(surfaces);
  Ray ray{{height, 0, 0.1}, {0, 0, -1}};
  EXPECT_EQ(lens.trace_to_sensor(ray), TraceStatus{});
  const double last = lens.vertices().back();
  const double slope = -ray.direction.x / ray.direction.z;  // per distance towards the sensor
  const double crossing = (last - ray.origin.z) - ray.origin.x / slope;
  const double focus = first_order(surfaces).back_focal_distance;
  const double from_vertex = ray.origin.x + slope * (focus - (last - ray.origin.z));
  return {crossing - focus, from_vertex};
}

TEST(LensSystem, AberrationsOfThePaperSinglet) {
  const double height[] = {10, 20, 30, 40, 50, 60};
  const double longitudinal[] = {-0.52790, -2.12126, -4.80972, -8.64515, -13.70566, -20.10233};
  const double transverse[] = {-0.01739, -0.14042, -0.48153, -1.16778, -2.35100, -4.22229};
  for (int i = 0; i < 6; ++i) {
    const AxisCrossing a = axial_ray(paper_singlet(0.125), 1e-3 * height[i]);
    EXPECT_TRUE(within(a.longitudinal, 1e-3 * longitudinal[i], 0.6e-5, 1e-3)) << height[i];
    EXPECT_TRUE(within(a.transverse, 1e-3 * transverse[i], 0.6e-5, 1e-3)) << height[i];
  }
}

TEST(LensSystem, ParaxialLimitIsApproachedQuadratically) {
  // LA / h^2 -> -5.27104101892 per metre at h = 0 (from 60-digit traces of meridional rays by
  // angles); what is left falls with h^2 again.
  double previous = 0;
  for (const double h : {16e-3, 8e-3, 4e-3, 2e-3}) {
    const double rest = axial_ray(paper_singlet(), h).longitudinal / (h * h) + 5.27104101892;
    EXPECT_TRUE(relative(rest, -79.55 * h * h, 0.01)) << h;
    if (previous != 0) {
      EXPECT_TRUE(relative(previous / rest, 4, 0.01)) << h;
    }
    previous = rest;
  }
}

TEST(LensSystem, DoubleGaussOfCodeV) {
  // Axial rays of the f/2 beam in the plane 0.400269 mm in front of the paraxial focus [mm].
  const double part[] = {1.0, 0.8, 0.6, 0.4};
  const double code_v[] = {0.014138, -0.012851, 0.007971, 0.022285};
  const double seven_digits[] = {0.014092, -0.012885, 0.007948, 0.022270};
  const std::vector<SurfaceSpec> surfaces = double_gauss();
  const FirstOrder first = first_order(surfaces);
  const LensSystem lens(surfaces);
  const double last = lens.vertices().back();
  for (int i = 0; i < 4; ++i) {
    Ray ray{{0.025 * part[i], 0, 0.1}, {0, 0, -1}};
    ASSERT_EQ(lens.trace_to_sensor(ray), TraceStatus{});
    const double plane = last - (61.487536e-3 - 0.400269e-3);
    const double t = (plane - ray.origin.z) / ray.direction.z;
    const double height = ray.at(t).x;
    EXPECT_TRUE(within(height, 1e-3 * code_v[i], 5e-5, 1e-3));
    EXPECT_TRUE(within(height, 1e-3 * seven_digits[i], 1e-5, 1e-3));
  }
  // Distortion of chief rays against the paraxial image height, in the paraxial focal plane.
  for (const auto& [degrees, percent] : {std::pair{10.0, -0.4976}, std::pair{14.0, -1.0557}}) {
    const double angle = degrees * std::acos(-1.0) / 180;
    // Aim so that the ray passes the centre of the stop: the pupil aberrates, so iterate (secant).
    double low = -2e-3, high = 2e-3;
    const auto stop_height = [&](double shift) {
      Ray ray{{shift, 0, -first.entrance_pupil}, {std::sin(angle), 0, -std::cos(angle)}};
      ray.origin = ray.at(-0.1);
      std::vector<Vec3> path;
      EXPECT_EQ(lens.trace_to_sensor(ray, &path), TraceStatus{});
      return path[5].x;
    };
    for (int k = 0; k < 60; ++k) {
      const double mid = 0.5 * (low + high);
      (stop_height(mid) < 0 ? low : high) = mid;
    }
    Ray ray{{0.5 * (low + high), 0, -first.entrance_pupil}, {std::sin(angle), 0, -std::cos(angle)}};
    ray.origin = ray.at(-0.1);
    ASSERT_EQ(lens.trace_to_sensor(ray), TraceStatus{});
    const double t = (last - first.back_focal_distance - ray.origin.z) / ray.direction.z;
    const double paraxial = first.focal_length * std::tan(angle);
    EXPECT_TRUE(within(100 * (ray.at(t).x / paraxial - 1), percent, 0.01, 1)) << degrees;
  }
}

TEST(LensSystem, FiftyDigitTraces) {
  for (const TracedSystem& system : traced_systems()) {
    const LensSystem lens(system.surfaces);
    for (const TracedRay& reference : system.rays) {
      SCOPED_TRACE(system.name);
      Ray ray{reference.origin, normalize(reference.direction)};
      const double extent = length(reference.exit_point - reference.origin);
      ASSERT_EQ(lens.trace_to_sensor(ray), TraceStatus{});
      EXPECT_TRUE(within(length(ray.origin - reference.exit_point), 0, 1e-14, extent));
      EXPECT_TRUE(within(length(ray.direction - reference.exit_direction), 0, 2e-15, 1));
      // The ray goes back along the same way, from the 50-digit exit. The deflection of a steep
      // surface amplifies the rounding of the reference.
      Ray back{reference.exit_point + 0.5 * extent * reference.exit_direction,
               -reference.exit_direction};
      ASSERT_EQ(lens.trace_to_scene(back), TraceStatus{});
      const Vec3 in = normalize(reference.direction);
      EXPECT_TRUE(within(length(back.direction + in), 0, 1e-13, 1));
      const Vec3 off = back.origin - reference.origin;
      EXPECT_TRUE(within(length(off - dot(off, in) * in), 0, 1e-13, extent));
    }
  }
}

TEST(LensSystem, TinyIndexStepKeepsItsDeflection) {
  // n - 1 = 1e-9: the deflection of the biconvex lens is that of the thin lens, 2 h (n-1) / R; the
  // direction itself only stores it to 1e-16.
  const double n = 1 + 1e-9, step = n - 1;
  const LensSystem lens({{0.05, 1e-6, n, 0.04, false}, {-0.05, 0, 1, 0.04, false}});
  for (const double h : {1e-4, 1e-3, 1e-2}) {
    Ray ray{{h, 0, 1}, {0, 0, -1}};
    ASSERT_EQ(lens.trace_to_sensor(ray), TraceStatus{});
    const double surface_slope = h / std::sqrt(0.05 * 0.05 - h * h);
    EXPECT_TRUE(relative(ray.direction.x, -2 * step * surface_slope, 1e-4));
  }
}

TEST(LensSystem, TotalInternalReflectionAtItsThreshold) {
  // From glass into air at a plane, from both sides of the critical angle.
  const double n = 1.5, critical = std::asin(1 / n);
  // A hemisphere entered radially keeps the direction, up to its plane.
  const LensSystem dome({{0.01, 0.01, n, 0.02, false}, {kInfinity, 0, 1, 0.02, false}});
  for (const double angle : {critical - 1e-7, critical + 1e-7, critical - 1e-3, critical + 1e-3}) {
    const Vec3 centre{0, 0, -0.01}, direction{std::sin(angle), 0, -std::cos(angle)};
    Ray ray{centre - 0.02 * direction, direction};
    const TraceStatus status = dome.trace_to_sensor(ray);
    if (angle > critical)
      EXPECT_EQ(status, (TraceStatus{RayStatus::total_internal_reflection, 1})) << angle - critical;
    else
      EXPECT_EQ(status, TraceStatus{}) << angle - critical;
  }
}

TEST(LensSystem, ClearApertureAndMiss) {
  const LensSystem lens(paper_singlet(0.1));
  for (const double turn : {0.0, 1.0, 2.5}) {
    const auto at = [&](double h) {
      Ray ray{{h * std::cos(turn), h * std::sin(turn), 1}, {0, 0, -1}};
      return lens.trace_to_sensor(ray);
    };
    EXPECT_EQ(at(0.05 * (1 - 1e-12)), TraceStatus{});
    EXPECT_EQ(at(0.05 * (1 + 1e-12)), (TraceStatus{RayStatus::vignetted, 0}));
    EXPECT_EQ(at(0.2), (TraceStatus{RayStatus::vignetted, 0}));
    EXPECT_EQ(at(0.31), (TraceStatus{RayStatus::missed, 0}));
  }
  // Missed is reported although the point is outside the aperture as well; the second surface is
  // named by its place from the scene in both directions.
  const LensSystem small_back({{0.3, 0.02426, 1.5, 0.12, true}, {-0.3, 0, 1, 0.02, false}});
  Ray in{{0.03, 0, 1}, {0, 0, -1}}, out{{0.03, 0, -1}, {0, 0, 1}};
  EXPECT_EQ(small_back.trace_to_sensor(in), (TraceStatus{RayStatus::vignetted, 1}));
  EXPECT_EQ(small_back.trace_to_scene(out), (TraceStatus{RayStatus::vignetted, 1}));
  EXPECT_EQ(to_string(RayStatus::total_internal_reflection), "total internal reflection");
  EXPECT_EQ(to_string(RayStatus::missed), "missed");
}

TEST(LensSystem, SteepRaysMeetTheCapAtTheVertex) {
  // A ray that crosses the whole sphere must take the intersection on the vertex' side, whichever
  // way the surface is curved and the ray runs.
  const LensSystem convex({{0.01, 0.02, 1.5, 0.0199, false}, {-0.01, 0, 1, 0.0199, false}});
  Ray ray{{0.004, -0.003, 0.05}, {0, 0, -1}};
  std::vector<Vec3> path;
  ASSERT_EQ(convex.trace_to_sensor(ray, &path).status, RayStatus::reached);
  ASSERT_EQ(path.size(), 2u);
  EXPECT_GT(path[0].z, -0.01);
  EXPECT_LT(path[1].z, -0.01);
  const LensSystem concave({{-0.01, 0.001, 1.5, 0.015, false}, {kInfinity, 0, 1, 0.1, false}});
  ray = {{0.004, -0.003, 0.05}, {0, 0, -1}};
  path.clear();
  ASSERT_EQ(concave.trace_to_sensor(ray, &path).status, RayStatus::reached);
  EXPECT_TRUE(relative(path[0].z, 0.01 - std::sqrt(0.01 * 0.01 - 25e-6), 1e-12));
}

}  // namespace
}  // namespace plenoflame::test::lens_system_test
