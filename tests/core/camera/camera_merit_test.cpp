// Figures that cameras are judged by, against those by hand for thin lenses, and the effect of a
// change of a camera changes.
#include "plenoflame/camera/camera_merit.h"

#include <cmath>

#include "plenoflame/base/error.h"
#include "plenoflame/camera/resolution.h"
#include "support/approx.h"
#include "support/cameras.h"

namespace plenoflame::test::camera_merit_test {
namespace {

constexpr double kMm = 1e-3;
constexpr double kImage = 1000.0 / 9 * kMm;  ///< of an object at 1 m behind the lens of 100 mm

/// The same and a type that is sharp from where the first ends: 1/f' = 1/f + 2 p / (D B).
CameraSpec two_types() {
  CameraSpec spec = thin_camera();
  spec.array.types.push_back({"two", kInfinity, kInfinity, 1.5, 1 / 5.8 * kMm});
  return spec;
}

/// Distance of the object that is imaged a in front of the array.
double object_at(double a) {
  const double image = kImage + 1 * kMm - a;
  return 1 / (1 / (100 * kMm) - 1 / image);
}

MeritSpec at_depths(MeritKind kind, double near, double far, int depths = 7) {
  MeritSpec spec;
  spec.kind = kind;
  spec.near = near;
  spec.far = far;
  spec.depths = depths;
  return spec;
}

TEST(CameraMerit, DepthOfField) {
  // The mean of (s / p - 1)^2 beyond v = 0.6 and 1.4, over v from -0.2 (past infinity) to 2:
  // ((1.5 + 0.5)^3 + (5 - 3.5)^3) / 7.5 / 2.2. The midpoint rule of 600 steps is good to 1e-5.
  MeritSpec spec;
  spec.kind = MeritKind::depth;
  spec.array_near = 0.5 * kMm;
  spec.array_far = -5 * kMm;
  EXPECT_TRUE(relative(merit(Camera(thin_camera()), spec, false), -(8 + 3.375) / 16.5, 2e-5));
  // The second type is sharp for v = 1.4 to 2.2.
  EXPECT_TRUE(relative(merit(Camera(two_types()), spec, false), -8 / 16.5, 2e-5));
  // Covered without a gap.
  spec.array_near = 1 / 2.2 * kMm;
  spec.array_far = 1 / 0.6 * kMm;
  EXPECT_LT(-merit(Camera(two_types()), spec, false), 1e-20);
  EXPECT_LT(merit(Camera(thin_camera()), spec, false), -0.1);
}

TEST(CameraMerit, Light) {
  MeritSpec spec;
  spec.kind = MeritKind::light;
  // pi sin^2 of the cone of 40 mm at 112.11 mm.
  const double distance = kImage + 1 * kMm, half = 20 * kMm;
  const double expected =
      3.14159265358979323846 * half * half / (half * half + distance * distance);
  EXPECT_TRUE(relative(merit(Camera(thin_camera()), spec, false), expected, 1e-12));
}

TEST(CameraMerit, LeastResolution) {
  // At a = 1 mm B / a = 1/4, sharp. At 2 mm 1/8, blurred over 1.25 pixels. At 0.4 mm 5/8, blurred
  // over 3.75 pixels, and only 0.8 of the way to the total covering plane, |a| = 2 B.
  const Camera camera(thin_camera());
  const double sharp = 0.25, far = 0.125 / 1.25, near = 0.625 / 3.75 * 0.8;
  const auto least = [&](double from, double to, int depths) {
    return merit(camera, at_depths(MeritKind::resolution, object_at(from), object_at(to), depths),
                 false);
  };
  EXPECT_TRUE(relative(least(1 * kMm, 1 * kMm, 1), sharp, 1e-9));
  EXPECT_TRUE(relative(least(1 * kMm, 2 * kMm, 7), far, 1e-9));
  EXPECT_TRUE(relative(least(0.4 * kMm, 1 * kMm, 7), near, 1e-9));
  EXPECT_TRUE(relative(least(0.4 * kMm, 2 * kMm, 2), far, 1e-9));
  // One depth: the middle of the objects' distances.
  const double middle = 0.5 * (object_at(1 * kMm) + object_at(2 * kMm));
  EXPECT_TRUE(relative(
      merit(camera, at_depths(MeritKind::resolution, object_at(1 * kMm), object_at(2 * kMm), 1),
            false),
      merit(camera, at_depths(MeritKind::resolution, middle, middle, 7), false), 1e-12));
  // The better of two types counts: at v = 1 / 0.55 the second is sharp, and past |a| = 2 B.
  EXPECT_TRUE(relative(
      merit(Camera(two_types()),
            at_depths(MeritKind::resolution, object_at(0.55 * kMm), object_at(0.55 * kMm)), false),
      0.25 / 0.55, 1e-9));
}

TEST(CameraMerit, ResolutionByRays) {
  const Camera camera(thin_camera());
  const BlurTracer tracer(camera, 0);
  for (const double a : {0.2 * kMm, 0.4 * kMm, 1 * kMm, 2 * kMm}) {
    const double object = object_at(a);
    const double blur = std::max(1.0, tracer(object).all / (0.01 * kMm));
    const double expected = std::min(1.0, 0.25 * kMm / a) / blur * std::min(1.0, a / (0.5 * kMm));
    EXPECT_TRUE(relative(merit(camera, at_depths(MeritKind::resolution, object, object), true),
                         expected, 1e-9))
        << a;
  }
  // The formulas' blur at 2 mm is that of whole apertures; rays at the pupil's edge fill less.
  const double traced =
      merit(camera, at_depths(MeritKind::resolution, object_at(2 * kMm), object_at(2 * kMm)), true);
  EXPECT_GT(traced, 0.0999);
  EXPECT_LT(traced, 0.125);
}

TEST(CameraMerit, DistancesCountFromThePrincipalPlane) {
  // Thick lenses: the object that the first type sees sharp is imaged a0 in front of it.
  CameraSpec spec = preset_camera("paper-plenoptic2");
  spec.array.types.resize(1);
  spec.focus.conjugate = "type1";
  const Camera camera(spec);
  const double f = camera.microlenses()[0].first_order.focal_length,
               b = camera.microlenses()[0].sensor_distance;
  const double expected = b / (1 / (1 / f - 1 / b));
  // In focus at 1 m, by its own type.
  EXPECT_TRUE(
      relative(merit(camera, at_depths(MeritKind::resolution, 1, 1), false), expected, 1e-9));
}

TEST(CameraMerit, Volume) {
  const Camera camera(thin_camera());
  MeritSpec spec = at_depths(MeritKind::volume, 1, 1);
  // Nine times smaller: 6.667 mm or 666.7 pixels, a quarter of them resolved.
  spec.height = 60 * kMm;
  EXPECT_TRUE(relative(merit(camera, spec, false), 60 / 9.0 / 0.01 * 0.25, 1e-9));
  // 20 mm on a sensor of 10 mm: half is seen, of a third less use for what is cut off.
  spec.height = 180 * kMm;
  EXPECT_TRUE(relative(merit(camera, spec, false), 20 / 0.01 * 0.25 * 0.5 * 0.25, 1e-9));
  // The longer side may be the height.
  CameraSpec upright = thin_camera();
  upright.sensor = {500, 1000, 0.01 * kMm};
  EXPECT_TRUE(relative(merit(Camera(upright), spec, false), merit(camera, spec, false), 1e-12));
}

TEST(CameraMerit, NeedsAnArray) {
  CameraSpec bare = thin_camera();
  bare.array = {};
  bare.focus.conjugate = "sensor";
  EXPECT_THROW(merit(Camera(bare), {}, false), InputError);
}

TEST(CameraMerit, Overlap) {
  // Images 0.25 * 40 / 112.11 mm wide; their centres 0.1 * 112.361 / 112.111 mm apart.
  const double distance = kImage + 1 * kMm;
  const double wide = 0.25 * kMm * 40 * kMm / distance,
               apart = 0.1 * kMm * (distance + 0.25 * kMm) / distance;
  EXPECT_TRUE(relative(overlap_pixels(Camera(thin_camera())), (wide - apart) / (0.01 * kMm), 1e-9));
  CameraSpec open = thin_camera();
  open.lens.diameter = 60 * kMm;
  EXPECT_TRUE(relative(overlap_pixels(Camera(open)), (1.5 * wide - apart) / (0.01 * kMm), 1e-9));
}

TEST(CameraChange, FactorsAndFocalLengths) {
  CameraSpec spec = two_types();
  spec.focus.lens_distance = 0.11;
  CameraChange change;
  change.pitch = 1.1;
  change.sensor_distance = 1.2;
  change.aperture = 0.7;
  change.object_distance = 0.9;
  change.focal_lengths = {0.3 * kMm, 0.4 * kMm};
  const CameraSpec changed = changed_camera(spec, change);
  EXPECT_TRUE(relative(changed.array.pitch, 0.11 * kMm, 1e-15));
  EXPECT_TRUE(relative(changed.array.diameter, 0.11 * kMm, 1e-15));
  EXPECT_TRUE(relative(changed.array.sensor_distance, 0.3 * kMm, 1e-15));
  EXPECT_TRUE(relative(changed.lens.diameter, 28 * kMm, 1e-15));
  EXPECT_TRUE(relative(changed.focus.object_distance, 0.9, 1e-15));
  EXPECT_TRUE(relative(changed.focus.lens_distance, 0.099, 1e-15));
  EXPECT_EQ(changed.array.types[0].focal_length, 0.3 * kMm);
  EXPECT_EQ(changed.array.types[1].focal_length, 0.4 * kMm);
  // Without any, nothing changes.
  const CameraSpec same = changed_camera(spec, {});
  EXPECT_EQ(same.array.pitch, spec.array.pitch);
  EXPECT_EQ(same.array.types[1].focal_length, spec.array.types[1].focal_length);
}

TEST(CameraChange, RealLenses) {
  CameraSpec spec = preset_camera("paper-plenoptic2");
  spec.array.types[1].glass = "N-BK7";
  const std::size_t surfaces = spec.lens.surfaces.size();
  CameraChange change;
  change.aperture = 0.5;
  change.focal_lengths = {0.25 * kMm, 0.2 * kMm, 0.18 * kMm};
  for (const MicrolensFreedom freedom : {MicrolensFreedom::index, MicrolensFreedom::radius}) {
    change.freedom = freedom;
    const CameraSpec changed = changed_camera(spec, change);
    const Camera camera(changed);
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_TRUE(relative(camera.microlenses()[k].first_order.focal_length,
                           change.focal_lengths[k], 1e-12));
    const bool index = freedom == MicrolensFreedom::index;
    EXPECT_EQ(changed.array.types[1].glass, index ? "" : "N-BK7");
    EXPECT_EQ(changed.array.types[0].index == spec.array.types[0].index, !index);
    EXPECT_EQ(changed.array.types[0].radius_front == spec.array.types[0].radius_front, index);
    // The stop alone.
    for (std::size_t i = 0; i < surfaces; ++i)
      EXPECT_EQ(changed.lens.surfaces[i].diameter,
                (spec.lens.surfaces[i].stop ? 0.5 : 1.0) * spec.lens.surfaces[i].diameter);
  }
  // Plano-convex ones stay so: f = R / (n - 1).
  CameraChange other;
  other.freedom = MicrolensFreedom::radius;
  other.focal_lengths = {2 * kMm, 1.9 * kMm, 1.7 * kMm};
  const CameraSpec flat = changed_camera(preset_camera("raytrix-r29"), other);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_TRUE(std::isinf(flat.array.types[k].radius_front));
    EXPECT_TRUE(relative(flat.array.types[k].radius_back, 0.5 * other.focal_lengths[k], 1e-12));
  }
  change.freedom = MicrolensFreedom::thickness;
  EXPECT_THROW(changed_camera(spec, change), InputError);
}

}  // namespace
}  // namespace plenoflame::test::camera_merit_test
