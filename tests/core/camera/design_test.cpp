// First-order design against the closed forms' numbers, worked out by hand for the paper's camera
// (Perwass and Wietzke 2012; Opt. Express 25 (2017) 8274), and the singlet's spot against an
// independent trace.
#include "plenoflame/camera/design.h"

#include "support/approx.h"
#include "support/cameras.h"

namespace plenoflame::test::design_test {
namespace {

constexpr double kMm = 1e-3;

TEST(Design, DepthOfFieldOfThePapersTypes) {
  // B = 0.2534, D = 0.1, p = 0.01 mm; each further type by 1/f' = 1/f + 2 p / (D B).
  struct Row {
    double focal_length, near, focus, far;
  };
  double f = 0.233;
  for (const Row row :
       {Row{0.233, 1.35108, 2.89423, -20.359}, Row{0.19681, 0.65384, 0.88123, 1.35108},
        Row{0.17035, 0.43128, 0.51974, 0.65384}}) {
    EXPECT_TRUE(relative(f, row.focal_length, 3e-5));
    const SharpRange range = depth_of_field(f * kMm, 0.2534 * kMm, 0.1 * kMm, 0.01 * kMm);
    EXPECT_TRUE(relative(range.near, row.near * kMm, 1e-5));
    EXPECT_TRUE(relative(range.focus, row.focus * kMm, 1e-5));
    EXPECT_TRUE(relative(range.far, row.far * kMm, 3e-5));
    f = 1 / (1 / f + 2 * 0.01 / (0.1 * 0.2534));
  }
}

/// The paper's singlet with the aperture at its front.
std::vector<SurfaceSpec> singlet(double diameter) {
  return {{300 * kMm, 24.26 * kMm, 1.5, diameter, true}, {-300 * kMm, 0, 1, 120 * kMm, false}};
}

TEST(Design, ObjectDistanceInvertsTheImageDistance) {
  const FirstOrder lens = first_order(singlet(100 * kMm));
  for (const double object : {0.31, 1.0, 50.0})
    EXPECT_TRUE(relative(paraxial_object_distance(lens, paraxial_image_distance(lens, object)),
                         object, 1e-11));
  EXPECT_LT(paraxial_object_distance(lens, 0.2), 0);  // converging light
}

TEST(Design, SpotOfThePapersSinglet) {
  const SpotDesign spot = best_spot(singlet(100 * kMm), kInfinity, 0);
  // Discs of equal area by rings: within 0.1 % of the integral.
  EXPECT_TRUE(relative(spot.rms, 0.3871 * kMm, 2e-3));
  EXPECT_TRUE(relative(spot.shift, 9.12 * kMm, 2e-3));
  EXPECT_TRUE(relative(best_spot(singlet(120 * kMm), kInfinity, 0).rms, 0.6910 * kMm, 2e-3));
  // The centroid does not count, the field's aberrations do.
  EXPECT_GT(best_spot(singlet(100 * kMm), kInfinity, 20 * kMm).rms, spot.rms);
}

TEST(Design, PapersCamera) {
  const CameraDesign d = design(Camera(preset_camera("paper-plenoptic2")));
  EXPECT_TRUE(relative(d.lens.focal_length, 304.0986 * kMm, 1e-6));
  EXPECT_TRUE(relative(d.lens.back_focal_distance, 295.9014 * kMm, 1e-6));
  ASSERT_EQ(d.types.size(), 3u);
  const double focal_lengths[] = {0.23365, 0.19888, 0.17079};
  for (std::size_t k = 0; k < 3; ++k) {
    const TypeDesign& type = d.types[k];
    EXPECT_TRUE(relative(type.focal_length, focal_lengths[k] * kMm, 3e-5));
    EXPECT_TRUE(type.keplerian);
    EXPECT_TRUE(relative(1 / type.array.near - 1 / type.array.far, type.dioptric_width, 1e-9));
  }
  EXPECT_TRUE(relative(d.types[0].dioptric_width, 789.27, 1e-5));
  EXPECT_TRUE(relative(d.types[0].sensor_distance, 0.2534 * kMm, 1e-9));
  // Focused at 1 m by the second type.
  EXPECT_TRUE(relative(d.types[1].object.focus, 1, 1e-9));
  EXPECT_TRUE(passes_infinity(d.types[0].array.near, d.types[0].array.far));
  EXPECT_LT(d.types[0].array.far, 0);
  EXPECT_TRUE(relative(d.covering_depth, 2, 1e-15));
  EXPECT_GT(d.joint_ratio, 2.5);
  EXPECT_LT(d.joint_ratio, 3.1);
  // Micro-image: the stop of 100 mm at the rear vertex, seen from the array: a0 of the second type
  // (0.92 mm) behind the image of the object at 1 m.
  EXPECT_TRUE(relative(d.types[0].image_diameter, 0.2534 * 100 / (427.2409 + 0.92) * kMm, 2e-4));
  bool hidden = false;
  for (const std::string& warning : d.warnings)
    hidden |= warning.find("cannot be seen") != std::string::npos;
  EXPECT_TRUE(hidden);
}

TEST(Design, IdealLensHasNoSpot) {
  CameraSpec spec = preset_camera("paper-plenoptic2");
  spec.lens.model = LensModel::ideal;
  EXPECT_TRUE(design(Camera(spec)).spots.empty());
}

TEST(Design, GalileanTypesLookBehindTheArray) {
  CameraSpec spec = preset_camera("paper-plenoptic2");
  spec.array.model = LensModel::ideal;
  spec.array.types = {{"long", kInfinity, kInfinity, 1.5, 0.4 * kMm}};
  spec.array.thickness = 0;
  spec.focus.conjugate = "long";
  const TypeDesign type = design(Camera(spec)).types.front();
  EXPECT_FALSE(type.keplerian);
  EXPECT_TRUE(relative(type.array.focus, 1 / (1 / (0.4 * kMm) - 1 / (0.2534 * kMm)), 1e-12));
  EXPECT_LT(type.virtual_depth, 0);
  // From one place behind the array to another.
  EXPECT_LT(type.array.near, 0);
  EXPECT_LT(type.array.far, 0);
  EXPECT_FALSE(passes_infinity(type.array.near, type.array.far));
}

// A thin lens of 100 mm with an object at `distance`: the image at the array is 100 mm away for
// infinity. The types of the R29 are sharp from -2.4 to -4 mm behind the array.
TEST(Design, InfinityIsWithinARangeOrNot) {
  CameraSpec spec = preset_camera("raytrix-r29");
  const auto through = [&](double distance) {
    spec.focus.object_distance = distance;
    std::vector<bool> within;
    for (const TypeDesign& type : design(Camera(spec)).types)
      within.push_back(type.object_through_infinity);
    return within;
  };
  EXPECT_EQ(through(1), (std::vector<bool>{false, false, false}));
  // Focused at infinity by the middle type (a = -3 mm), as it is within that type's range only.
  EXPECT_EQ(through(kInfinity), (std::vector<bool>{false, true, false}));
  EXPECT_EQ(through(100), (std::vector<bool>{false, true, false}));
}

}  // namespace
}  // namespace plenoflame::test::design_test
