#include "plenoflame/optics/first_order.h"

#include <cmath>

#include "prescriptions.h"
#include "support/approx.h"

namespace plenoflame::test::first_order_test {
namespace {

/// Closed forms of a thick lens in air, radii positive when convex.
struct ThickLens {
  double power, focal_length, back, front, rear_principal, front_principal;
};
ThickLens thick_lens(double n, double r1, double r2, double t) {
  const double k1 = (n - 1) / r1, k2 = (n - 1) / r2;
  const double power = k1 + k2 - k1 * k2 * t / n;
  const double f = 1 / power;
  return {power, f, f * (1 - k1 * t / n), -f * (1 - k2 * t / n), -f * k1 * t / n, f * k2 * t / n};
}

TEST(FirstOrder, PaperSinglet) {
  const FirstOrder lens = first_order(paper_singlet());
  const ThickLens exact = thick_lens(1.5, 0.3, 0.3, 0.02426);
  EXPECT_TRUE(relative(lens.focal_length, exact.focal_length, 1e-14));
  EXPECT_TRUE(relative(lens.back_focal_distance, exact.back, 1e-14));
  EXPECT_TRUE(relative(lens.front_focal_distance, exact.front, 1e-14));
  EXPECT_TRUE(relative(lens.rear_principal, exact.rear_principal, 1e-14));
  EXPECT_TRUE(relative(lens.front_principal, exact.front_principal, 1e-14));
  // The same, worked out with 20 digits.
  EXPECT_TRUE(relative(lens.focal_length, 0.304098572989288972, 1e-14));
  EXPECT_TRUE(relative(lens.back_focal_distance, 0.295901427010711028, 1e-14));
  EXPECT_TRUE(relative(lens.length, 0.02426, 1e-15));
}

TEST(FirstOrder, Microlenses) {
  ArraySpec array;
  array.thickness = 5e-5;
  array.diameter = 1e-4;
  const double index[] = {1.50, 1.59, 1.69};
  // docs/theory/optics.md, first-order optics, and the closed form.
  const double focal_mm[] = {0.23365, 0.19888, 0.17079}, back_mm[] = {0.21635, 0.18248, 0.15530};
  for (int i = 0; i < 3; ++i) {
    const FirstOrder lens = first_order(array, {"", 2.25e-4, 2.25e-4, index[i], 0});
    const ThickLens exact = thick_lens(index[i], 2.25e-4, 2.25e-4, 5e-5);
    EXPECT_TRUE(relative(lens.focal_length, exact.focal_length, 1e-14));
    EXPECT_TRUE(relative(lens.back_focal_distance, exact.back, 1e-14));
    EXPECT_TRUE(within(lens.focal_length, 1e-3 * focal_mm[i], 0.5e-5, 1e-3));
    EXPECT_TRUE(within(lens.back_focal_distance, 1e-3 * back_mm[i], 0.5e-5, 1e-3));
  }
}

TEST(FirstOrder, DoubleGaussAsPrinted) {
  std::vector<SurfaceSpec> surfaces = double_gauss();
  const FirstOrder lens = first_order(surfaces);
  const double mm = 1e-3, digit = 0.5e-4;  // the table has four decimals of a millimetre
  // An independent tracer with the same 7-digit indices gives 100.00366 and 61.48739: CODE V's own
  // 100.0038 and 61.4875 carry more digits of the indices.
  EXPECT_TRUE(within(lens.focal_length, 100.00366 * mm, 0.5e-5, mm));
  EXPECT_TRUE(within(lens.back_focal_distance, 61.48739 * mm, 0.5e-5, mm));
  EXPECT_TRUE(within(lens.focal_length, 100.0038 * mm, 2e-4, mm));
  EXPECT_TRUE(within(lens.back_focal_distance, 61.4875 * mm, 2e-4, mm));
  EXPECT_TRUE(within(lens.front_focal_distance, -29.3208 * mm, 2e-4, mm));
  EXPECT_TRUE(within(lens.entrance_pupil, 57.9120 * mm, digit, mm));
  EXPECT_TRUE(within(lens.exit_pupil, -53.1569 * mm, 2 * digit, mm));
  // The stop's diameter is not in the table: the pupils' ratio is, and an f/2 pupil of 50 mm.
  EXPECT_TRUE(
      within(lens.exit_pupil_diameter / lens.entrance_pupil_diameter, 57.3201 / 50, 2e-6, 1));
  EXPECT_EQ(lens.stop, 5);
  // The pupils are images of the stop, so they are each other's image through the whole lens.
  EXPECT_TRUE(
      relative(paraxial_image_distance(lens, -lens.entrance_pupil), lens.exit_pupil, 1e-12));
}

TEST(FirstOrder, PupilsOfSimpleLenses) {
  // A stop in front of a lens is its own entrance pupil; behind it its own exit pupil.
  const double f = 0.05, gap = 0.02;
  const double r = 0.5 * f;  // plano-convex, n = 1.5, without thickness: f = 2 R
  const FirstOrder front = first_order(
      {{kInfinity, gap, 1, 0.01, true}, {r, 0, 1.5, 0.02, false}, {kInfinity, 0, 1, 0.02, false}});
  EXPECT_TRUE(relative(front.focal_length, f, 1e-14));
  EXPECT_EQ(front.entrance_pupil, 0);
  EXPECT_TRUE(relative(front.entrance_pupil_diameter, 0.01, 1e-15));
  // The lens images the stop: 1/s' = 1/f - 1/gap, magnification s'/gap.
  const double image = 1 / (1 / f - 1 / gap);
  EXPECT_TRUE(relative(front.exit_pupil, image, 1e-13));
  EXPECT_TRUE(relative(front.exit_pupil_diameter, 0.01 * std::fabs(image / gap), 1e-13));

  const FirstOrder behind = first_order(
      {{r, 0, 1.5, 0.02, false}, {kInfinity, gap, 1, 0.02, false}, {kInfinity, 0, 1, 0.01, true}});
  EXPECT_EQ(behind.exit_pupil, 0);
  EXPECT_TRUE(relative(behind.exit_pupil_diameter, 0.01, 1e-15));
  // Mirrored: in front of the first vertex is negative.
  EXPECT_TRUE(relative(behind.entrance_pupil, -image, 1e-13));
  EXPECT_TRUE(relative(behind.entrance_pupil_diameter, front.exit_pupil_diameter, 1e-13));
}

TEST(FirstOrder, ThinAndAfocalLimits) {
  // Thin lenses in contact: powers add, principal planes at the lens.
  for (const double t : {1e-6, 1e-9, 1e-12}) {
    const FirstOrder thin = first_order({{0.1, t, 1.5, 0.01, true}, {-0.1, 0, 1, 0.01, false}});
    EXPECT_TRUE(relative(thin.focal_length, 0.1, 2 * t / 0.1));
    // Principal planes t/3 inside either vertex (n = 1.5), to first order in t.
    EXPECT_TRUE(relative(thin.front_principal, t / 3, 1e-3));
    EXPECT_TRUE(relative(thin.rear_principal, -t / 3, 1e-3));
  }
  // A glass plate has no power; an afocal telescope neither.
  const FirstOrder plate =
      first_order({{kInfinity, 0.01, 1.5, 0.02, true}, {kInfinity, 0, 1, 0.02, false}});
  EXPECT_TRUE(std::isinf(plate.focal_length));
  const FirstOrder kepler = first_order({{0.05, 0, 1.5, 0.02, true},
                                         {kInfinity, 0.1 + 0.05, 1, 0.02, false},
                                         {0.025, 0, 1.5, 0.02, false},
                                         {kInfinity, 0, 1, 0.02, false}});
  // Focal lengths 100 and 50 mm, 150 mm apart: afocal up to rounding.
  EXPECT_TRUE(within(1 / kepler.focal_length, 0, 1e-15, 1 / 0.05));
  // With parallel light in, its exit pupil (the image of the front lens) lies f2 (1 + f2/f1)
  // behind.
  EXPECT_TRUE(relative(kepler.exit_pupil, 0.05 * (1 + 0.05 / 0.1), 1e-13));
  EXPECT_TRUE(relative(kepler.exit_pupil_diameter, 0.02 / 2, 1e-13));
}

TEST(FirstOrder, FiniteConjugatesOfTheSinglet) {
  const FirstOrder lens = first_order(paper_singlet());
  const double object_mm[] = {1000, 1300, 1500, 1800, 5000};
  const double image_mm[] = {427.2409, 387.9999, 372.7024, 357.3841, 315.5600};
  for (int i = 0; i < 5; ++i)
    EXPECT_TRUE(within(paraxial_image_distance(lens, 1e-3 * object_mm[i]), 1e-3 * image_mm[i],
                       0.5e-4, 1e-3));
  EXPECT_TRUE(within(paraxial_magnification(lens, 1.0), -0.43190, 0.5e-5, 1));
  // Gauss' equation between the principal planes, over nine orders of magnitude.
  for (double object = 0.31; object < 1e9; object *= 3) {
    const double s = object + lens.front_principal;
    const double gauss = 1 / (1 / lens.focal_length - 1 / s) + lens.rear_principal;
    EXPECT_TRUE(relative(paraxial_image_distance(lens, object), gauss, 1e-12)) << object;
    EXPECT_TRUE(
        relative(paraxial_magnification(lens, object), -(gauss - lens.rear_principal) / s, 1e-12));
  }
  // Inside the focal length the image is virtual, and the limits are reached.
  EXPECT_LT(paraxial_image_distance(lens, 0.2), 0);
  EXPECT_TRUE(std::isinf(paraxial_image_distance(lens, -lens.front_focal_distance)));
  EXPECT_EQ(paraxial_image_distance(lens, kInfinity), lens.back_focal_distance);
  EXPECT_EQ(paraxial_magnification(lens, kInfinity), 0);
}

TEST(FirstOrder, ReversedLens) {
  // Turned around, front and back swap, the focal length stays.
  const std::vector<SurfaceSpec> surfaces = double_gauss();
  std::vector<SurfaceSpec> reversed;
  for (std::size_t i = surfaces.size(); i-- > 0;) {
    SurfaceSpec s = surfaces[i];
    s.radius = -s.radius;
    s.thickness = i > 0 ? surfaces[i - 1].thickness : 0;
    s.index = i > 0 ? surfaces[i - 1].index : 1;
    reversed.push_back(s);
  }
  const FirstOrder a = first_order(surfaces), b = first_order(reversed);
  EXPECT_TRUE(relative(b.focal_length, a.focal_length, 1e-13));
  EXPECT_TRUE(relative(b.back_focal_distance, -a.front_focal_distance, 1e-13));
  EXPECT_TRUE(relative(b.front_focal_distance, -a.back_focal_distance, 1e-13));
  EXPECT_TRUE(relative(b.entrance_pupil, -a.exit_pupil, 1e-13));
  EXPECT_TRUE(relative(b.exit_pupil_diameter, a.entrance_pupil_diameter, 1e-13));
  EXPECT_TRUE(relative(b.rear_principal, -a.front_principal, 1e-12));
}

TEST(FirstOrder, ThinLensWithoutSurfaces) {
  MainLensSpec lens;
  lens.model = LensModel::ideal;
  lens.focal_length = 0.05;
  lens.diameter = 0.02;
  const FirstOrder f = first_order(lens);
  EXPECT_EQ(f.focal_length, 0.05);
  EXPECT_EQ(f.back_focal_distance, 0.05);
  EXPECT_EQ(f.front_focal_distance, -0.05);
  EXPECT_EQ(f.rear_principal, 0);
  EXPECT_EQ(f.exit_pupil, 0);
  EXPECT_EQ(f.exit_pupil_diameter, 0.02);
}

TEST(FirstOrder, ThinMicrolens) {
  ArraySpec array;
  array.model = LensModel::ideal;
  array.thickness = 5e-5;  // which a thin lens does not have
  MicrolensSpec type;
  type.focal_length = -2e-4;
  const FirstOrder f = first_order(array, type);
  EXPECT_EQ(f.focal_length, -2e-4);
  EXPECT_EQ(f.back_focal_distance, -2e-4);
  EXPECT_EQ(f.front_focal_distance, 2e-4);
  EXPECT_EQ(f.front_principal, 0);
  EXPECT_EQ(f.rear_principal, 0);
  EXPECT_EQ(f.length, 0);
}

}  // namespace
}  // namespace plenoflame::test::first_order_test
