// Bare lenses against the published analysis of CODE V's sample double Gauss, and closed forms of a
// single refracting surface.
#include "plenoflame/camera/lens_design.h"

#include <cmath>
#include <limits>

#include "core/optics/prescriptions.h"
#include "plenoflame/base/error.h"
#include "support/approx.h"

namespace plenoflame::test::lens_design_test {
namespace {

constexpr double kMm = 1e-3, kDegree = 3.14159265358979323846 / 180;

/// With the stop that makes the entrance pupil the published 50 mm, and room for the beams.
std::vector<SurfaceSpec> published_double_gauss() {
  auto surfaces = double_gauss();
  surfaces[5].diameter *= 50 * kMm / first_order(surfaces).entrance_pupil_diameter;
  return surfaces;
}

TEST(LensDesign, DistortionOfTheDoubleGauss) {
  const auto surfaces = published_double_gauss();
  // The listing has its image surface 0.400269 mm before the paraxial image, and prints where the
  // chief ray meets it and the tangent of its angle there [mm, 1]. Its distortion is that in the
  // paraxial image over the height f tan(field), which it moves to the image surface along the
  // chief ray: 0.34 % more than over f tan(field) itself, which is what distortion is here.
  const double focus = -0.400269, efl = 100.0038;
  struct Row {
    double angle, height, tangent, published;
  };
  for (const auto& [angle, height, tangent, published] :
       {Row{10.0, 17.485856, 0.150057, -0.4976}, Row{14.0, 24.588739, 0.206467, -1.0557}}) {
    const LensDesign d = design_lens(surfaces, kInfinity, angle * kDegree, 2, 0);
    ASSERT_EQ(d.fields.size(), 2u);
    const double ideal = efl * std::tan(angle * kDegree);
    const double expected = 100 * ((height - focus * tangent) / ideal - 1);
    // Indices of 7 digits agree to 5e-5 mm.
    EXPECT_TRUE(within(d.fields[1].image_height / kMm, height - focus * tangent, 5e-5, 1));
    EXPECT_TRUE(within(100 * d.fields[1].distortion, expected, 100 * 5e-5 / ideal, 1));
    const double moved = d.fields[1].distortion * ideal / (ideal + focus * tangent);
    EXPECT_TRUE(within(100 * moved, published, 5e-5 + 100 * 5e-5 / ideal, 1));
    EXPECT_GT(d.fields[1].throughput, 0.3);
    // In the image surface itself.
    const LensDesign there = design_lens(surfaces, kInfinity, angle * kDegree, 2, focus * kMm);
    EXPECT_TRUE(within(there.fields[1].image_height / kMm, height, 5e-5, 1));
  }
}

TEST(LensDesign, AxialFanOfTheDoubleGauss) {
  const LensDesign d = design_lens(published_double_gauss(), kInfinity, 0, 1, -0.400269 * kMm);
  ASSERT_EQ(d.fields.size(), 1u);
  const auto error_at = [&](double pupil) {
    for (const FanPoint& p : d.fields[0].tangential_fan)
      if (std::fabs(p.pupil - pupil) < 1e-9) return p.error / kMm;
    return std::numeric_limits<double>::quiet_NaN();
  };
  // Published for the paraxial pupil of 50 mm; indices of 7 digits agree to 5e-5 mm.
  const double expected[][2] = {{0.8, -0.012851}, {0.6, 0.007971}, {0.4, 0.022285}};
  for (const auto& [pupil, error] : expected)
    EXPECT_TRUE(within(error_at(pupil), error, 5e-5, 1)) << pupil;
  EXPECT_TRUE(within(error_at(-0.6), -0.007971, 5e-5, 1));
}

TEST(LensDesign, FieldCurvatureOfASingleSurface) {
  // A stop at the centre of a sphere: no coma, no astigmatism, image on a sphere around the centre
  // of curvature. Plano-convex backwards: plane stop in air, then concentric...
  const double n = 1.5, r = 20 * kMm;
  // Half ball: light enters the plane (the stop, at the centre of the sphere) and leaves through
  // the sphere around it.
  const std::vector<SurfaceSpec> half_ball = {{kInfinity, r, n, 2 * kMm, true},
                                              {-r, 0, 1, 30 * kMm, false}};
  const LensDesign d = design_lens(half_ball, kInfinity, 20 * kDegree, 2, 0);
  const double inner = std::asin(std::sin(20 * kDegree) / n);
  // Chief rays pass the centre, undeviated by the sphere; the image is r / (n - 1) beyond it for
  // the sagittal beam, whose width the plane does not change.
  const double beyond = r / (n - 1);
  EXPECT_TRUE(relative(d.lens.back_focal_distance, beyond, 1e-12));
  const double radius = r + beyond;
  EXPECT_TRUE(relative(d.fields[1].sagittal, radius * std::cos(inner) - radius, 1e-4));
  EXPECT_TRUE(relative(d.fields[1].tangential, d.fields[1].sagittal, 1e-4));
  // Distortion: tan(inner) radius against f tan(20 deg), f = r / (n - 1) * ...: f = radius / n.
  EXPECT_TRUE(relative(d.lens.focal_length, radius / n, 1e-12));
  EXPECT_TRUE(relative(1 + d.fields[1].distortion,
                       std::tan(inner) * radius / (radius / n * std::tan(20 * kDegree)), 1e-9));
}

TEST(LensDesign, SpotOfThePapersSinglet) {
  const LensDesign d = design_lens(
      {{300 * kMm, 24.26 * kMm, 1.5, 100 * kMm, true}, {-300 * kMm, 0, 1, 120 * kMm, false}},
      kInfinity, 1 * kDegree, 2, std::numeric_limits<double>::quiet_NaN());
  EXPECT_TRUE(relative(d.focus, -9.12 * kMm, 2e-3));
  EXPECT_TRUE(relative(d.fields[0].rms, 0.3871 * kMm, 1e-2));
  EXPECT_TRUE(relative(d.fields[0].throughput, 1, 1e-12));
  EXPECT_GT(d.greatest_field, 20 * kDegree);
}

TEST(LensDesign, FiniteDistance) {
  // Paraxial scale for an object at 1 m: -0.43190 times its height.
  const LensDesign d = design_lens(
      {{300 * kMm, 24.26 * kMm, 1.5, 4 * kMm, true}, {-300 * kMm, 0, 1, 120 * kMm, false}}, 1.0,
      0.5 * kDegree, 2, 0);
  EXPECT_TRUE(relative(d.image_distance, 427.2409 * kMm, 1e-6));
  EXPECT_TRUE(relative(d.fields[1].image_height, 0.43190 * std::tan(0.5 * kDegree), 1e-4));
  EXPECT_LT(std::fabs(d.fields[1].distortion), 1e-4);
}

TEST(LensDesign, Errors) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<SurfaceSpec> singlet = {{300 * kMm, 24.26 * kMm, 1.5, 100 * kMm, true},
                                            {-300 * kMm, 0, 1, 120 * kMm, false}};
  EXPECT_THROW(design_lens(singlet, 0.2, 0, 1, nan), InputError);
  auto no_stop = singlet;
  no_stop[0].stop = false;
  EXPECT_THROW(design_lens(no_stop, kInfinity, 0, 1, nan), InputError);
  auto diverging = singlet;
  diverging[0].radius = -0.1;
  EXPECT_THROW(design_lens(diverging, kInfinity, 0, 1, nan), InputError);
  EXPECT_THROW(design_lens(published_double_gauss(), kInfinity, 60 * kDegree, 2, 0), InputError);
}

}  // namespace
}  // namespace plenoflame::test::lens_design_test
