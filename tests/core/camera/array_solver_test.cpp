// The array's rule against the paper's numbers, corrected by hand (its focal lengths and the
// indices that its own formula gives), and against closed forms of thin and plano-convex lenses.
#include "plenoflame/camera/array_solver.h"

#include <cmath>

#include "plenoflame/base/error.h"
#include "support/approx.h"
#include "support/cameras.h"

namespace plenoflame::test::array_solver_test {
namespace {

constexpr double kMm = 1e-3;
constexpr double kDiameter = 0.1 * kMm;
const MicrolensShape kPaper{0.225 * kMm, 0.225 * kMm, 1.5, 0.05 * kMm};

TEST(ArraySolver, ThickLens) {
  // 40 digits with mpmath: 1 / (0.5 (2 / 0.225 - 0.5 * 0.05 / (1.5 * 0.225^2))).
  EXPECT_TRUE(relative(thick_focal_length(kPaper), 0.23365384615384615385 * kMm, 1e-14));
  MicrolensShape plano{kInfinity, 1 * kMm, 1.5, 0.2 * kMm};
  EXPECT_TRUE(relative(thick_focal_length(plano), 2 * kMm, 1e-15));
}

TEST(ArraySolver, RuleOfThePaper) {
  const auto f = joined_focal_lengths(0.233 * kMm, 0.2534 * kMm, kDiameter, 0.01 * kMm, 3);
  ASSERT_EQ(f.size(), 3u);
  EXPECT_TRUE(relative(f[0], 0.233 * kMm, 1e-15));
  EXPECT_TRUE(relative(f[1], 0.19681 * kMm, 3e-5));
  EXPECT_TRUE(relative(f[2], 0.17035 * kMm, 3e-5));
  EXPECT_THROW(joined_focal_lengths(-0.233 * kMm, 0.2534 * kMm, kDiameter, 0.01 * kMm, 2),
               InputError);
}

TEST(ArraySolver, IndicesOfThePaper) {
  // The printed 0.197 and 0.170 mm need 1.5958 and 1.6933, not the printed 1.59 and 1.69.
  const MicrolensLimits limits;
  const auto index = [&](double f) {
    return solve_microlens(kPaper, f * kMm, kDiameter, MicrolensFreedom::index, limits).index;
  };
  EXPECT_TRUE(relative(index(0.197), 1.5958, 4e-5));
  EXPECT_TRUE(relative(index(0.170), 1.6933, 4e-5));
  EXPECT_TRUE(relative(index(0.23365384615384615385), 1.5, 1e-14));
  // Concave-convex: the other sign of S - T.
  const MicrolensShape meniscus{0.2 * kMm, -0.6 * kMm, 1.7, 0.05 * kMm};
  EXPECT_TRUE(relative(solve_microlens(meniscus, thick_focal_length(meniscus), kDiameter,
                                       MicrolensFreedom::index, limits)
                           .index,
                       1.7, 1e-13));
}

TEST(ArraySolver, RadiusAndThickness) {
  const MicrolensLimits limits;
  // Plano-convex: f = R / (n - 1).
  const MicrolensShape plano{kInfinity, 1 * kMm, 1.5, 0.05 * kMm};
  EXPECT_TRUE(relative(
      solve_microlens(plano, 0.5 * kMm, kDiameter, MicrolensFreedom::radius, limits).radius_back,
      0.25 * kMm, 1e-14));
  // A ball lens: f = n R / (2 (n - 1)), thickness 2 R.
  const MicrolensShape ball{0.1 * kMm, 0.1 * kMm, 1.5, 0.1 * kMm};
  EXPECT_TRUE(relative(
      solve_microlens(ball, 0.15 * kMm, kDiameter, MicrolensFreedom::thickness, limits).thickness,
      0.2 * kMm, 1e-13));
  const MicrolensShape scaled{0.3 * kMm, 0.3 * kMm, 1.5, 0.2 * kMm};
  EXPECT_TRUE(
      relative(solve_microlens(scaled, thick_focal_length({0.15 * kMm, 0.15 * kMm, 1.5, 0.2 * kMm}),
                               kDiameter, MicrolensFreedom::radius, limits)
                   .radius_front,
               0.15 * kMm, 1e-13));
}

TEST(ArraySolver, Limits) {
  const auto solve = [](double f, MicrolensFreedom freedom, MicrolensLimits limits) {
    return solve_microlens(kPaper, f * kMm, kDiameter, freedom, limits);
  };
  MicrolensLimits limits;
  limits.greatest_index = 1.6;
  EXPECT_NO_THROW(solve(0.197, MicrolensFreedom::index, limits));
  EXPECT_THROW(solve(0.170, MicrolensFreedom::index, limits), InputError);
  // R = 0.225 f / f1 or so: half the diameter is 0.05 mm, the rims meet before.
  EXPECT_THROW(solve(0.04, MicrolensFreedom::radius, {}), InputError);
  limits.least_radius = 0.2 * kMm;
  EXPECT_THROW(solve(0.17, MicrolensFreedom::radius, limits), InputError);
  // Thickness only lengthens f of a biconvex lens.
  EXPECT_THROW(solve(0.2, MicrolensFreedom::thickness, {}), InputError);
  limits.greatest_thickness = 0.06 * kMm;
  EXPECT_THROW(solve(0.26, MicrolensFreedom::thickness, limits), InputError);
  EXPECT_THROW(solve(-0.2, MicrolensFreedom::index, {}), InputError);
}

// Ends in 1/m by another program: meridional rays by angles (law of sines) with 20 digits, the same
// 64 heights, bisection.
constexpr double kTracedNear[] = {897.081, 1711.848, 2538.457},
                 kTracedFar[] = {155.869, 978.944, 1814.062};

TEST(ArraySolver, RaysConfirmTheRule) {
  const CameraSpec camera = preset_camera("paper-plenoptic2");
  const auto types = solve_array(camera.array, camera.sensor.pixel_pitch, 3,
                                 MicrolensFreedom::index, MicrolensLimits{});
  ASSERT_EQ(types.size(), 3u);
  const double width = 2 * 0.01 / (0.1 * 0.2534) / kMm;
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_TRUE(relative(thick_focal_length(types[k].shape), types[k].target, 1e-13));
    EXPECT_TRUE(relative(1 / types[k].rule.near - 1 / types[k].rule.far, width, 1e-9));
    if (k > 0) {
      EXPECT_TRUE(relative(types[k].rule.far, types[k - 1].rule.near, 1e-9));
    }
    // Lenses of f / 2.5 focus a quarter of the range short; their ranges still nearly join.
    ASSERT_TRUE(types[k].traced.has_value());
    EXPECT_TRUE(relative(1 / types[k].traced->near, kTracedNear[k], 1e-5));
    EXPECT_TRUE(relative(1 / types[k].traced->far, kTracedFar[k], 1e-5));
  }
}

TEST(ArraySolver, RaysOfAWeakLensAgreeClosely) {
  // f / 250: no aberrations to speak of, thin: the formulas are exact to (D / f)^2.
  const MicrolensShape weak{kInfinity, 2.5 * kMm, 1.5, 1e-3 * kMm};
  const auto traced = traced_depth_of_field(weak, 6 * kMm, 0.02 * kMm, 0.002 * kMm);
  const SharpRange rule = depth_of_field(5 * kMm, 6 * kMm, 0.02 * kMm, 0.002 * kMm);
  ASSERT_TRUE(traced.has_value());
  EXPECT_TRUE(relative(traced->near, rule.near, 1e-3));
  EXPECT_TRUE(relative(traced->focus, rule.focus, 1e-3));
  EXPECT_TRUE(relative(traced->far, rule.far, 1e-3));
}

}  // namespace
}  // namespace plenoflame::test::array_solver_test
