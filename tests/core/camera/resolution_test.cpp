// Effective resolution and traced blur against closed forms: a thin lens' defocus, and the
// longitudinal aberration of the paper's singlet from an independent trace.
#include "plenoflame/camera/resolution.h"

#include <algorithm>
#include <cmath>

#include "support/approx.h"
#include "support/cameras.h"

namespace plenoflame::test::resolution_test {
namespace {

constexpr double kMm = 1e-3;

TEST(Resolution, ClosedForm) {
  TypeDesign type;
  type.focal_length = 0.2 * kMm;
  type.sensor_distance = 0.25 * kMm;
  const double d = 0.1 * kMm, p = 0.01 * kMm;
  // In focus, a = 1 mm: 1 / v.
  EXPECT_TRUE(relative(effective_resolution(type, d, p, 1 * kMm), 0.25, 1e-12));
  // At a = 2 mm: s = 0.1 |0.25 (5 - 0.5) - 1| = 0.0125 mm.
  EXPECT_TRUE(relative(effective_resolution(type, d, p, 2 * kMm), 0.125 * 0.8, 1e-12));
  // Behind the array: s = 0.1 |0.25 (5 + 0.5) - 1| = 0.0375 mm.
  EXPECT_TRUE(relative(effective_resolution(type, d, p, -2 * kMm), 0.125 / 3.75, 1e-12));
  // Not more pixels than there are.
  EXPECT_TRUE(relative(effective_resolution(type, d, 1, 0.1 * kMm), 1, 1e-12));
  // Diffraction.
  EXPECT_TRUE(relative(effective_resolution(type, d, p, 1 * kMm, 0.02 * kMm), 0.125, 1e-12));
}

TEST(Resolution, BlurOfThinLensesIsTheirDefocus) {
  const Camera camera(thin_camera());
  const BlurTracer tracer(camera, 0);
  // Object distances whose images lie at a = 0.6, 1.6 and 4 mm in front of the array.
  for (const double a : {0.6 * kMm, 1.6 * kMm, 4 * kMm}) {
    const double image = 1000.0 / 9 * kMm + (1 * kMm - a);
    const double object = 1 / (1 / (100 * kMm) - 1 / image);
    const double blur = 0.1 * kMm * std::fabs(0.25 * kMm * (1 / (0.2 * kMm) - 1 / a) - 1);
    const TracedBlur traced = tracer(object);
    EXPECT_TRUE(relative(traced.central, blur, 1e-3));
    // The edge of the pupil cuts the beams of the outermost microlenses.
    EXPECT_LT(traced.all, 1.001 * blur);
    EXPECT_GT(traced.all, 0.8 * blur);
  }
  EXPECT_LT(tracer(1.0).all, 1e-6 * kMm);
}

TEST(Resolution, ZonesOfTheSingletFocusElsewhere) {
  CameraSpec spec = preset_camera("paper-plenoptic2");
  spec.array.model = LensModel::ideal;  // its own aberrations are another test's
  const Camera camera(spec);
  const double pixel = camera.spec().sensor.pixel_pitch;
  // Through the lens on the axis, the first type is as sharp as the formulas say; its 12 um span 8
  // % of the main lens.
  const TracedBlur far = BlurTracer(camera, 0)(1.0);
  EXPECT_LT(far.central, pixel);
  // The zone at 0.84 of the pupil focuses some 14 mm short, so that there the image is at
  // a = 15 mm: blurred by 0.1 |0.2516 (1/0.17079 - 1/15) - 1| = 0.046 mm behind the third type.
  const TracedBlur third = BlurTracer(camera, 2)(1.0);
  EXPECT_GT(third.all, 3 * pixel);
  EXPECT_LT(third.all, 5 * pixel);
  // The zones at sqrt((k + 1/2) / 5) focus 14 mm (h / 0.84)^2 short of the first, which is sharp:
  // along the zone. Across it, as aberrations of third order do, three times as far.
  double squares = 0;
  for (int k = 1; k < 5; ++k) {
    const double a = 14 * kMm * (k + 0.5) / 5 / (0.84 * 0.84);
    const double blur = 0.1 * kMm * std::fabs(0.2516 * (1 / 0.17079 - kMm / a) - 1);
    squares += std::pow(blur * a / (0.2516 * kMm) / (0.5 + 0.5 / 3), 2);
  }
  EXPECT_TRUE(relative(traced_resolution(third, pixel), pixel / std::sqrt(squares / 5), 0.15));
}

// Without aberrations of the main lens rays and formulas agree where thick microlenses are sharp.
TEST(Resolution, SharpThroughThickMicrolenses) {
  CameraSpec spec = preset_camera("paper-plenoptic2");
  spec.lens.model = LensModel::ideal;
  const Camera camera(spec);
  const double pixel = camera.spec().sensor.pixel_pitch;
  const auto types = design_types(camera);
  for (std::size_t k = 0; k < types.size(); ++k) {
    const double a = camera.microlenses()[k].sharp_distance;
    const double object = paraxial_object_distance(
        camera.lens_first_order(),
        camera.rear_vertex() - (camera.microlenses()[k].front_principal + a));
    EXPECT_TRUE(relative(traced_resolution(BlurTracer(camera, k)(object), 10 * pixel),
                         std::fabs(types[k].sensor_distance / a), 0.02))
        << k;
  }
}

TEST(Resolution, CurveOfThinLenses) {
  const Camera camera(thin_camera());
  const auto curve = resolution_curve(camera, 41);
  ASSERT_EQ(curve.size(), 41u);
  double best = 0, best_at = 0;
  for (const ResolutionPoint& p : curve) {
    EXPECT_GT(p.object_distance, 0);
    // Nearer than this the pupil does not fill a microlens.
    if (p.array_distance > 0.5 * kMm) {
      EXPECT_GT(p.traced[0], 0.999 * p.paraxial[0]);
      EXPECT_LT(p.traced[0], 1.3 * p.paraxial[0]);
    }
    EXPECT_TRUE(relative(p.paraxial_joint, p.paraxial[0], 1e-15));
    // Beyond the total covering plane.
    if (p.array_distance > 0.36 * kMm && p.paraxial_joint > best)
      best = p.paraxial_joint, best_at = p.array_distance;
  }
  // 1 / v falls; a pixel of blur is allowed down to a0- = 1/(5 - 0.9/0.25) = 0.714 mm.
  EXPECT_GT(best, 0.25);
  EXPECT_LT(best, 0.36);
  EXPECT_GT(best_at, 0.6 * kMm);
  EXPECT_LT(best_at, 1.0 * kMm);
}

TEST(Resolution, CountsAndViews) {
  const CameraDesign d = design(Camera(thin_camera()));
  // f-number of the main lens at 1 m: (111.11 + 1) / 40; the micro-image 0.25 * 40 / 112.11 mm.
  const double image = 0.25 * 40 / (1000.0 / 9 + 1) * kMm;
  EXPECT_TRUE(relative(d.types[0].image_diameter, image, 1e-12));
  EXPECT_TRUE(relative(d.views.across, image / (0.01 * kMm), 1e-12));
  // Centres on the sensor (pitch 0.1 * 112.361 / 112.111 mm) at most 4.9554 x 2.4554 mm from the
  // middle, so 49 and 24 to each side; rows of the hexagonal one at 0.08679 mm: 28, of which every
  // other one is shifted by half a lens (49 more to the right, 50 to the left): 99 * 29 + 98 * 28.
  EXPECT_EQ(d.square.lenses, 99 * 49);
  EXPECT_EQ(d.hexagonal.lenses, 99 * 29 + 98 * 28);
  EXPECT_TRUE(relative(d.square.used_share,
                       99 * 49 * 0.78539816339744831 * image * image / (10 * 5 * kMm * kMm),
                       1e-12));
  // One metre away lenses stand 9 (= 1/m) times as far apart, seen from the pupil.
  EXPECT_TRUE(
      relative(d.views.object_pixel, 9 * 0.1 * (1000.0 / 9) / (1000.0 / 9 + 1) * kMm, 1e-9));
  // Longitudinal magnification 1/81; a changes by 1/81 m per m.
  EXPECT_TRUE(relative(d.types[0].disparity_rate, 0.1 * 0.25 / 0.01 / 81 / 1 / kMm, 1e-9));
  EXPECT_TRUE(relative(d.views.disparity_rate,
                       40 / (1000.0 / 9) / 81 / (0.1 * kMm * (1000.0 / 9) / (1000.0 / 9 + 1)),
                       1e-9));
}

TEST(Resolution, HexagonalArraysHoldMore) {
  const CameraDesign d = design(Camera(preset_camera("paper-plenoptic2")));
  EXPECT_TRUE(relative(double(d.hexagonal.lenses) / d.square.lenses, 2 / std::sqrt(3), 5e-3));
}

}  // namespace
}  // namespace plenoflame::test::resolution_test
