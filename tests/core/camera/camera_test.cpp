#include "plenoflame/camera/camera.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "plenoflame/base/error.h"
#include "support/approx.h"
#include "support/cameras.h"

namespace plenoflame::test::camera_test {
namespace {

CameraSpec singlet(double stop_diameter) {
  CameraSpec camera = preset_camera("paper-plenoptic2");
  camera.array = {};
  camera.focus.conjugate = "sensor";
  camera.lens.surfaces[2].diameter = stop_diameter;
  if (stop_diameter > 0.1)
    camera.lens.surfaces[0].diameter = camera.lens.surfaces[1].diameter = 0.13;
  return camera;
}

TEST(CameraFocus, ParaxialConjugates) {
  const double object_mm[] = {1000, 1300, 1500, 1800, 5000};
  const double image_mm[] = {427.2409, 387.9999, 372.7024, 357.3841, 315.5600};
  for (int i = 0; i < 5; ++i) {
    CameraSpec spec = singlet(0.1);
    spec.focus.object_distance = 1e-3 * object_mm[i];
    const Camera camera(spec);
    EXPECT_TRUE(within(camera.lens_distance(), 1e-3 * image_mm[i], 0.5e-4, 1e-3));
    EXPECT_TRUE(relative(camera.sensor(), camera.rear_vertex() - camera.lens_distance(), 1e-15));
  }
}

TEST(CameraFocus, BestFocusOfTheSinglet) {
  // Object at infinity, beams of 100 and 120 mm: place inside the paraxial focus and size of the
  // least RMS blur over equal areas (40-digit meridional traces by mpmath). The stop lies on the
  // front here.
  for (const auto& [diameter, inside, rms] :
       {std::tuple{0.1, 9.1111613e-3, 0.38710236e-3}, {0.12, 13.345796e-3, 0.69104317e-3}}) {
    MainLensSpec lens;
    lens.surfaces = {{0.3, 0.02426, 1.5, diameter, true}, {-0.3, 0, 1, 0.16, false}};
    const double best = best_image_distance(lens, kInfinity);
    EXPECT_TRUE(relative(first_order(lens).back_focal_distance - best, inside, 2e-5));
    const LensSystem system(lens.surfaces);
    double squares = 0;
    constexpr int kRays = 4000;
    for (int i = 0; i < kRays; ++i) {
      Ray ray{{0.5 * diameter * std::sqrt((i + 0.5) / kRays), 0, 0.1}, {0, 0, -1}};
      ASSERT_EQ(system.trace_to_sensor(ray), TraceStatus{});
      const double z = system.vertices().back() - best;
      const double height = ray.at((z - ray.origin.z) / ray.direction.z).x;
      squares += height * height / kRays;
    }
    EXPECT_TRUE(relative(std::sqrt(squares), rms, 1e-5));
  }
}

/// The camera of Sun et al. (ChinaXiv 201711.00595): thin lenses, three types.
CameraSpec sun_camera() {
  CameraSpec camera;
  camera.lens.model = LensModel::ideal;
  camera.lens.focal_length = 0.05;
  camera.lens.diameter = 0.01;
  camera.array.present = true;
  camera.array.model = LensModel::ideal;
  camera.array.pitch = camera.array.diameter = 9.5e-5;
  camera.array.types = {{"a", kInfinity, kInfinity, 1.5, 6.5e-4},
                        {"b", kInfinity, kInfinity, 1.5, 6.0e-4},
                        {"c", kInfinity, kInfinity, 1.5, 5.5e-4}};
  camera.array.sensor_distance = 4.4e-4;
  camera.sensor = {720, 720, 8e-6};
  camera.focus.mode = FocusMode::distance;
  camera.focus.lens_distance = 0.05414;
  return camera;
}

TEST(CameraFocus, ConjugatesOfSunEtAl) {
  const Camera camera(sun_camera());
  const double virtual_image[] = {-1.3619, -1.6500, -2.2000}, object[] = {504.39, 481.8, 444.3};
  for (std::size_t i = 0; i < 3; ++i) {
    const double sharp = camera.microlenses()[i].sharp_distance;
    EXPECT_TRUE(within(sharp, 1e-3 * virtual_image[i], 0.5e-4, 1e-3));
    const double image = camera.lens_distance() - sharp;
    EXPECT_TRUE(within(1 / (1 / 0.05 - 1 / image), 1e-3 * object[i], 0.05, 1e-3));
    // The other way round: focused on that distance by the type's name, the array stands there.
    CameraSpec focused = sun_camera();
    focused.focus.mode = FocusMode::paraxial;
    focused.focus.object_distance = 1 / (1 / 0.05 - 1 / image);
    focused.focus.conjugate = focused.array.types[i].name;
    EXPECT_TRUE(relative(Camera(focused).lens_distance(), camera.lens_distance(), 1e-12));
  }
}

TEST(CameraFocus, DepthRangesOfPerwassAndWietzke) {
  CameraSpec spec = sun_camera();
  spec.array.sensor_distance = 0.2534e-3;
  spec.array.types[0].focal_length = 0.23300e-3;
  spec.array.types[1].focal_length = 1e-3 / (1 / 0.233 + 0.02 / (0.1 * 0.2534));
  spec.array.types[2].focal_length = 1e-3 / (1 / 0.233 + 0.04 / (0.1 * 0.2534));
  const Camera camera(spec);
  const double sharp[] = {2.89423, 0.88123, 0.51974};
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_TRUE(within(camera.microlenses()[i].sharp_distance, 1e-3 * sharp[i], 0.6e-5, 1e-3)) << i;
}

TEST(CameraFocus, ASensorPointOfTheNamedTypeIsSharpInTheObjectPlane) {
  // Plenoptic 2.0 with ideal lenses: all rays of a sensor point through one lens of that type meet
  // in the object plane; those of the other types do not.
  for (const char* type : {"type1", "type2", "type3"}) {
    CameraSpec spec = preset_camera("paper-plenoptic2");
    spec.lens.model = spec.array.model = LensModel::ideal;
    spec.focus.conjugate = type;
    spec.focus.object_distance = 1.2;
    const Camera camera(spec);
    for (int index = 0; index < 3; ++index) {
      const LensIndex lens{index, 0};
      const int own = camera.lattice().type(lens);
      const Vec2 centre = camera.lattice().centre(lens), point = centre + Vec2{1.1e-5, -7e-6};
      std::vector<Vec2> hits;
      for (const Vec2 u : {Vec2{0, 0}, {2e-5, 0}, {-1e-5, 3e-5}, {0, -2e-5}}) {
        const Camera::Path path = camera.trace(point, lens, centre + u);
        ASSERT_EQ(path.status, TraceStatus{});
        const Vec3 hit = path.exit.at((1.2 - path.exit.origin.z) / path.exit.direction.z);
        hits.push_back({hit.x, hit.y});
      }
      double spread = 0;
      for (const Vec2 hit : hits) spread = std::max(spread, length(hit - hits[0]));
      const bool named = camera.microlenses()[static_cast<std::size_t>(own)].name == type;
      if (named)
        EXPECT_TRUE(within(spread, 0, 1e-11, 1.2)) << type;
      else
        EXPECT_GT(spread, 2e-5) << type;
    }
  }
}

TEST(CameraFocus, TheArrayItselfIsConjugateToTheObject) {
  // Plenoptic 1.0: all sensor points seen through one point of a microlens see one object point.
  CameraSpec spec = preset_camera("paper-plenoptic1");
  spec.lens.model = spec.array.model = LensModel::ideal;
  const Camera camera(spec);
  const Vec2 centre = camera.lattice().centre({1, 2}), aim = centre + Vec2{1e-5, -2e-5};
  std::vector<Vec2> hits;
  for (const Vec2 s : {Vec2{0, 0}, {2e-5, 0}, {-1e-5, 2e-5}}) {
    const Camera::Path path = camera.trace(centre + s, LensIndex{1, 2}, aim);
    ASSERT_EQ(path.status, TraceStatus{});
    const Vec3 hit =
        path.exit.at((spec.focus.object_distance - path.exit.origin.z) / path.exit.direction.z);
    hits.push_back({hit.x, hit.y});
  }
  for (const Vec2 hit : hits) EXPECT_TRUE(within(length(hit - hits[0]), 0, 1e-11, 1));
}

TEST(Camera, IdealLensIsTheParaxialLimitOfTheRealOne) {
  CameraSpec real = singlet(0.1), ideal = real;
  ideal.lens.model = LensModel::ideal;
  const Camera a(real), b(ideal);
  double previous = 0;
  for (int k = 0; k < 4; ++k) {
    const double part = std::ldexp(1.0, -k);
    const Vec2 sensor{4e-3 * part, -2e-3 * part};
    const Camera::Path pa = a.trace(sensor, std::nullopt, {0.01 * part, 0.012 * part});
    // The ideal lens is aimed at on its principal plane: continue the same straight line.
    const double stretch = (b.aim_plane(0) - b.sensor()) / (a.aim_plane(0) - a.sensor());
    const Vec2 aim = sensor + stretch * (Vec2{0.01 * part, 0.012 * part} - sensor);
    const Camera::Path pb = b.trace(sensor, std::nullopt, aim);
    ASSERT_EQ(pa.status, TraceStatus{});
    ASSERT_EQ(pb.status, TraceStatus{});
    const auto at = [](const Ray& ray) { return ray.at((1.0 - ray.origin.z) / ray.direction.z); };
    const double error = length(at(pa.exit) - at(pb.exit));
    if (k > 0) {
      EXPECT_TRUE(within(previous / error, 8, 0.15, 8));  // third order
    }
    previous = error;
  }
}

TEST(Camera, FramesAndSensorPoints) {
  const Camera camera(preset_camera("paper-plenoptic2"));
  // At the origin, looking along +x; camera x (right) is -y, camera y (down) is -z.
  const RigidTransform& world = camera.to_world();
  EXPECT_TRUE(within(length(world.direction({0, 0, 1}) - Vec3{1, 0, 0}), 0, 1e-15, 1));
  EXPECT_TRUE(within(length(world.direction({1, 0, 0}) - Vec3{0, -1, 0}), 0, 1e-15, 1));
  EXPECT_TRUE(within(length(world.direction({0, 1, 0}) - Vec3{0, 0, -1}), 0, 1e-15, 1));
  // Upright columns and rows run against camera x and y on the sensor.
  EXPECT_EQ(camera.sensor_point(1500, 1500), (Vec2{0, 0}));
  EXPECT_TRUE(relative(camera.sensor_point(1501, 1500).x, -1e-5, 1e-12));
  EXPECT_TRUE(relative(camera.sensor_point(1500, 1499).y, 1e-5, 1e-12));
}

TEST(Camera, SurfaceNames) {
  const Camera camera(preset_camera("paper-plenoptic2"));
  ASSERT_EQ(camera.surface_count(), 5);
  EXPECT_EQ(camera.surface_name(0), "main lens surface 1");
  EXPECT_EQ(camera.surface_name(2), "main lens surface 3 (stop)");
  EXPECT_EQ(camera.surface_name(3), "microlens front");
  EXPECT_EQ(camera.surface_name(4), "microlens back");
  // A ray beyond a microlens' clear edge is stopped there, one beyond the stop at the stop.
  EXPECT_EQ(camera.trace({0, 0}, LensIndex{}, {6e-5, 0}).status.surface, 4);
  EXPECT_EQ(camera.trace({5e-5, 0}, LensIndex{}, {0, 0}).status.surface, 2);
  const Camera::Path path = camera.trace({0, 0}, LensIndex{}, {0, 0}, true);
  EXPECT_EQ(path.points.size(), 6u);  // the sensor point and five surfaces
}

std::string error_of(const CameraSpec& spec) {
  try {
    const Camera camera(spec);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Camera, WhatCannotExist) {
  CameraSpec spec = singlet(0.1);
  spec.up = spec.look_direction;
  EXPECT_NE(error_of(spec).find("camera.up"), std::string::npos);
  spec = singlet(0.1);
  spec.focus.object_distance = 0.2;
  EXPECT_NE(error_of(spec).find("inside the front focal distance"), std::string::npos);
  spec = singlet(0.1);
  spec.lens.surfaces[0].radius = spec.lens.surfaces[1].radius = kInfinity;
  EXPECT_NE(error_of(spec).find("does not converge"), std::string::npos);
  spec = singlet(0.1);
  spec.lens.surfaces[2].stop = false;
  EXPECT_NE(error_of(spec).find("stop = true"), std::string::npos);
  spec = preset_camera("paper-plenoptic2");
  spec.focus.conjugate = "nonsense";
  EXPECT_NE(error_of(spec).find("nonsense"), std::string::npos);
  spec = preset_camera("paper-plenoptic2");
  spec.array.sensor_distance = 1e-6;
  EXPECT_NE(error_of(spec).find("inside the microlenses"), std::string::npos);
}

}  // namespace
}  // namespace plenoflame::test::camera_test
