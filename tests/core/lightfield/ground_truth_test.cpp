// Ground truth against closed forms of thin lenses, rendered white images, and rays the other way.
#include "plenoflame/lightfield/ground_truth.h"

#include <cmath>
#include <map>
#include <sstream>

#include "plenoflame/media/uniform_medium.h"
#include "plenoflame/render/render.h"
#include "support/approx.h"
#include "support/cameras.h"

namespace plenoflame::test::ground_truth_test {
namespace {

constexpr double kMm = 1e-3;

/// Thin lenses throughout: f = 50 mm, microlenses of 0.3 mm, not touching.
CameraSpec thin_camera() {
  CameraSpec spec = preset_camera("raytrix-r29");
  spec.lens.focal_length = 50 * kMm;
  spec.lens.diameter = 10 * kMm;
  spec.array.model = LensModel::ideal;
  spec.array.pitch = 0.12 * kMm;
  spec.array.diameter = 0.1 * kMm;
  spec.array.thickness = 0;
  spec.array.sensor_distance = 0.5 * kMm;
  spec.array.types = {{"one", kInfinity, kInfinity, 1.5, 0.3 * kMm}};
  spec.sensor = {80, 60, 5e-6};
  spec.focus = {FocusMode::paraxial, 0, 1.0, "array"};
  return spec;
}

TEST(GroundTruth, MicroImagesOfThinLenses) {
  CameraSpec spec = thin_camera();
  spec.array.rotation = 0.02;
  spec.array.offset = {3e-6, -7e-6};
  spec.array.centre_jitter = 8e-6;
  spec.array.spacing_error = 30e-6;
  const Camera camera(spec);
  const MicroImages images(camera, false, one_thread());
  const auto truth = micro_image_truth(images);
  ASSERT_GT(truth.size(), 10u);
  // Array at 1000/19 mm from the lens, whose stop is at the lens: centres are projected from there.
  const double distance = 1000.0 / 19 * kMm, b = 0.53 * kMm;
  for (const MicroImageTruth& t : truth) {
    const Vec2 lens = camera.lattice().centre(t.lens);
    const double scale = (distance + b) / distance;
    EXPECT_TRUE(within(t.centre.x, 40 - scale * lens.x / 5e-6, 2e-6, 80));
    EXPECT_TRUE(within(t.centre.y, 30 - scale * lens.y / 5e-6, 2e-6, 60));
    EXPECT_TRUE(relative(t.radius, 0.5 * 10 * kMm * b / distance / 5e-6, 1e-2));
  }
  const std::string csv = micro_image_csv(truth, spec);
  EXPECT_EQ(csv.substr(0, csv.find('\n')), "q,r,type,column,row,radius");
}

TEST(GroundTruth, MicroImagesOfAMisalignedCamera) {
  // Through the middle of the stop, which is the thin lens, and of each microlens straight on.
  CameraSpec spec = thin_camera();
  spec.lens.decentre = {2 * kMm, -1 * kMm};
  spec.lens.tilt = {0.01, -0.02};
  spec.array.tilt = {0.03, 0.05};
  spec.array.focal_jitter = 0.05;
  const Camera camera(spec);
  const auto truth = micro_image_truth(MicroImages(camera, false, one_thread()));
  ASSERT_GT(truth.size(), 10u);
  const double distance = 1000.0 / 19 * kMm;  // lens to array; B = 0.5 mm behind
  const Mat3 turn = rotation_xyz({0.03, 0.05, 0});
  const Vec3 stop{2 * kMm, -1 * kMm, 0};
  for (const MicroImageTruth& t : truth) {
    const Vec2 cell = camera.lattice().centre(t.lens);
    const Vec3 lens = Vec3{0, 0, -distance} + turn * Vec3{cell.x, cell.y, 0};
    const double scale = (stop.z + distance + 0.5 * kMm) / (stop.z - lens.z);
    const Vec3 s = stop + scale * (lens - stop);
    EXPECT_TRUE(within(t.centre.x, 40 - s.x / 5e-6, 2e-6, 80));
    EXPECT_TRUE(within(t.centre.y, 30 - s.y / 5e-6, 2e-6, 60));
    EXPECT_TRUE(relative(t.radius,
                         0.5 * 10 * kMm * (lens.z + distance + 0.5 * kMm) / distance / 5e-6, 1e-2));
  }
}

TEST(GroundTruth, JitterStaysInItsDisc) {
  ArraySpec array = thin_camera().array;
  const MicrolensLattice straight(array);
  array.centre_jitter = 9e-6;
  const MicrolensLattice moved(array);
  array.jitter_seed = 2;
  const MicrolensLattice other(array);
  double sum = 0, x = 0, count = 0;
  for (int q = -60; q <= 60; ++q)
    for (int r = -60; r <= 60; ++r) {
      const Vec2 shift = moved.centre({q, r}) - straight.centre({q, r});
      EXPECT_LE(length(shift), 9e-6 * (1 + 1e-9));
      sum += dot(shift, shift), x += shift.x, count += 1;
      EXPECT_EQ(other.centre({q, r}) == moved.centre({q, r}), q == 0 && r == 0);
      // A lens is found again from its own centre and from its rim.
      EXPECT_TRUE((moved.nearest(moved.centre({q, r})) == LensIndex{q, r}));
      EXPECT_TRUE((moved.nearest(moved.centre({q, r}) + Vec2{-0.049e-3, 0}) == LensIndex{q, r}));
    }
  // Uniform over a disc: <r^2> = R^2 / 2 with a standard deviation of R^2 / sqrt(12).
  EXPECT_TRUE(within_standard_errors(sum / count, 0.5 * 81e-12, 81e-12 / std::sqrt(12 * count), 5));
  EXPECT_TRUE(within_standard_errors(x / count, 0, 4.5e-6 / std::sqrt(count), 5));
  const Vec2 corner{1e-3, 0.5e-3};
  for (const LensIndex lens : moved.within({-corner.x, -corner.y}, corner)) {
    const Vec2 c = moved.centre(lens);
    EXPECT_TRUE(std::fabs(c.x) <= corner.x && std::fabs(c.y) <= corner.y);
  }
}

/// Centroids of white micro-images by lens, whole ones only.
/// @param beyond pixels around the truth's radius that count as well
void expect_centroids(const CameraSpec& spec, double tolerance, double beyond = 1.5) {
  CompiledScene scene = scene_of(spec, make_uniform_medium(1, 1));
  RenderSettings settings;
  settings.samples = 128;
  const LightField field = render(scene, settings, one_thread()).light_field;
  const Image& flux = field.channels.front().flux;
  const MicroImages images(scene.camera, false, one_thread());
  int compared = 0;
  for (const MicroImageTruth& t : micro_image_truth(images)) {
    const double reach = t.radius + beyond;
    if (t.centre.x < reach || t.centre.y < reach || t.centre.x + reach > flux.width ||
        t.centre.y + reach > flux.height)
      continue;
    double sum = 0, x = 0, y = 0;
    for (int row = static_cast<int>(t.centre.y - reach); row <= t.centre.y + reach; ++row)
      for (int column = static_cast<int>(t.centre.x - reach); column <= t.centre.x + reach;
           ++column) {
        if (std::hypot(column + 0.5 - t.centre.x, row + 0.5 - t.centre.y) > reach) continue;
        const double value = static_cast<double>(flux.at(column, row));
        sum += value, x += value * (column + 0.5), y += value * (row + 0.5);
      }
    ASSERT_GT(sum, 0);
    EXPECT_TRUE(within(x / sum, t.centre.x, tolerance, 1)) << t.lens.q << ' ' << t.lens.r;
    EXPECT_TRUE(within(y / sum, t.centre.y, tolerance, 1)) << t.lens.q << ' ' << t.lens.r;
    ++compared;
  }
  EXPECT_GE(compared, 3);
}

TEST(GroundTruth, CentresAreCentroidsOfAWhiteImageOfIdealLenses) {
  // In thin lenses the stop's image, flux included, is symmetric but for cos^4. The sensor in the
  // microlenses' focus, so that micro-images are sharp and do not touch.
  CameraSpec spec = thin_camera();
  spec.array.sensor_distance = 0.3 * kMm;
  spec.array.centre_jitter = 9e-6;
  expect_centroids(spec, 0.01);
}

TEST(GroundTruth, CentresAreCentroidsOfAWhiteImageOfAMisalignedCamera) {
  CameraSpec spec = preset_camera("paper-plenoptic2");
  spec.sensor.columns = spec.sensor.rows = 48;
  spec.lens.decentre = {0.5 * kMm, -0.3 * kMm};
  spec.lens.tilt = {0.002, -0.003};
  // A tenth of a degree. Tilts do to real microlenses what a place far off the axis does: coma.
  spec.array.tilt = {0.001, -0.0015};
  spec.array.focal_jitter = 0.02;
  expect_centroids(spec, 0.05);
}

TEST(GroundTruth, CentresAreCentroidsUnderATiltOfADegree) {
  // Microlenses so far apart that no light of neighbours is counted; where micro-images touch, that
  // moves centroids by up to 0.08 pixel. What remains, 0.009 pixel, and 0.015 with ideal lenses, is
  // the tilt: one side of the aperture is nearer to the sensor, by theta u at height u, which moves
  // the light of a lens out of focus by theta a^2 / (4 B), 0.004 pixel, and E goes as
  // cos^3(alpha) cos(alpha - theta), which adds theta rho^2 / (4 B), 0.002 pixel.
  for (const LensModel model : {LensModel::real, LensModel::ideal}) {
    CameraSpec spec = preset_camera("paper-plenoptic2");
    spec.sensor.columns = spec.sensor.rows = 120;
    spec.lens.model = spec.array.model = model;
    spec.array.pitch = 0.25 * kMm;
    spec.array.tilt = {0, 3.14159265358979 / 180};
    expect_centroids(spec, 0.05, 7);
  }
}

TEST(GroundTruth, OffAxisCentroidsAreShiftedByObliquity) {
  // Ideal lenses, small aperture: the light of a sensor point goes as cos^4 of the direction in
  // which it sees the microlens. Over the stop's image, a disc of radius rho at t from below the
  // lens, its gradient moves the centroid by -rho^2 t / (B^2 + t^2), to first order.
  CameraSpec spec = thin_camera();
  spec.array.sensor_distance = 0.3 * kMm;
  spec.array.diameter = 0.02 * kMm;
  spec.lens.diameter = 12 * kMm;
  const double b = 0.3 * kMm, distance = 1000.0 / 19 * kMm, pixel = 5e-6;
  const double rho = 6 * kMm * b / distance;
  for (const double field : {8.0, 16.0}) {
    spec.array.offset = {field * kMm, 0};
    // The sensor's middle stays on the axis: wide enough to hold the micro-image of lens (0, 0).
    spec.sensor = {2 * static_cast<int>(field * 1.02 * kMm / pixel) + 40, 40, pixel};
    CompiledScene scene = scene_of(spec, make_uniform_medium(1, 1));
    const auto truth = micro_image_truth(MicroImages(scene.camera, false, one_thread()));
    const MicroImageTruth* own = nullptr;
    for (const MicroImageTruth& t : truth)
      if (t.lens == LensIndex{}) own = &t;
    ASSERT_NE(own, nullptr);
    RenderSettings settings;
    settings.samples = 4096;
    const int left = static_cast<int>(own->centre.x) - 11,
              top = static_cast<int>(own->centre.y) - 11;
    settings.window = {left, top, 23, 23};
    const Image flux = render(scene, settings, one_thread()).light_field.channels.front().flux;
    double sum = 0, x = 0;
    for (int row = 0; row < 23; ++row)
      for (int column = 0; column < 23; ++column) {
        const double value = static_cast<double>(flux.at(column, row));
        sum += value, x += value * (left + column + 0.5);
      }
    const double t = field * kMm * b / distance;  // columns run against x
    const double expected = rho * rho * t / (b * b + t * t) / pixel;
    EXPECT_GT(expected, 0.02);
    EXPECT_TRUE(relative(x / sum - own->centre.x, expected, 0.1)) << field;
  }
}

TEST(GroundTruth, CentresAreCentroidsOfAWhiteImageOfRealLenses) {
  CameraSpec spec = preset_camera("paper-plenoptic2");
  spec.sensor.columns = spec.sensor.rows = 48;
  expect_centroids(spec, 0.05);
}

TEST(GroundTruth, ProjectionsOfAPointByThinLenses) {
  // Point at 0.6 m: imaged at 1/(1/50 - 1/600) = 54.545 mm; the array stands at 52.632 mm.
  const CameraSpec spec = thin_camera();
  const Camera camera(spec);
  const Vec3 point{1.2 * kMm, -0.7 * kMm, 0.6};
  const auto images = project_point(camera, camera.to_world().point(point));
  ASSERT_GT(images.size(), 2u);
  const double image = 1 / (1 / 0.05 - 1 / 0.6), array = 1 / (1 / 0.05 - 1.0);
  const Vec2 at = (-image / 0.6) * Vec2{point.x, point.y};
  for (const PointTruth& t : images) {
    // The straight line through the middle of the microlens, towards the image behind it.
    const Vec2 lens = camera.lattice().centre(t.lens);
    const Vec2 s = lens + (0.5 * kMm / (image - array)) * (at - lens);
    EXPECT_TRUE(within(t.pixel.x, 40 - s.x / 5e-6, 1e-7, 80));
    EXPECT_TRUE(within(t.pixel.y, 30 - s.y / 5e-6, 1e-7, 60));
  }
  EXPECT_TRUE(project_point(camera, camera.to_world().point({0, 0, -1})).empty());
}

TEST(GroundTruth, PointWithinTheFocalLengthIsSeenByEveryMicrolensThatItLights) {
  // At 20 mm before a lens of f = 50 mm, imaged at 1/(1/50 - 1/20) = -33.3 mm: rays diverge.
  CameraSpec spec = thin_camera();
  spec.sensor.columns = 400;
  spec.sensor.rows = 300;
  const Camera camera(spec);
  const double image = 1 / (1 / 0.05 - 1 / 0.02), array = 1 / (1 / 0.05 - 1.0);
  for (const Vec3 point : {Vec3{0, 0, 0.02}, Vec3{1.8 * kMm, -1.1 * kMm, 0.02}}) {
    const Vec2 at = (-image / 0.02) * Vec2{point.x, point.y};
    std::map<std::pair<int, int>, Vec2> expected;
    for (const LensIndex lens : camera.lattice().within({-8 * kMm, -8 * kMm}, {8 * kMm, 8 * kMm})) {
      const Vec2 centre = camera.lattice().centre(lens);
      // The straight line through the middle of the microlens that seems to come from the image.
      const Vec2 along = (1 / (array - image)) * (centre - at);
      if (length(at - image * along) > 5 * kMm) continue;  // beside the main lens
      const Vec2 s = centre + 0.5 * kMm * along;
      const Vec2 pixel{200 - s.x / 5e-6, 150 - s.y / 5e-6};
      if (pixel.x > 0 && pixel.y > 0 && pixel.x < 400 && pixel.y < 300)
        expected[{lens.q, lens.r}] = pixel;
    }
    ASSERT_GT(expected.size(), 100U);
    double told = 0;
    Execution execution = threads(2);
    execution.progress = [&](const Progress& progress) { told = progress.fraction; };
    const auto images = project_point(camera, camera.to_world().point(point), execution);
    EXPECT_EQ(told, 1);
    EXPECT_EQ(images.size(), expected.size());
    for (const PointTruth& t : images) {
      const auto place = expected.find({t.lens.q, t.lens.r});
      ASSERT_TRUE(place != expected.end()) << t.lens.q << ' ' << t.lens.r;
      EXPECT_TRUE(within(t.pixel.x, place->second.x, 1e-7, 400));
      EXPECT_TRUE(within(t.pixel.y, place->second.y, 1e-7, 300));
    }
  }
}

TEST(GroundTruth, ChiefRaysMeetWhatTheyProject) {
  // Real optics: the chief ray of the pixel in which a point is imaged passes near it.
  CameraSpec spec = preset_camera("paper-plenoptic2");
  spec.sensor.columns = spec.sensor.rows = 64;
  const Camera camera(spec);
  const MicroImages images(camera, false, one_thread());
  LightField field;
  field.sensor_width = field.sensor_height = 64;
  field.window = {0, 0, 64, 64};
  add_chief_rays(images, field);
  const Vec3 in_camera{0.1 * kMm, 0.2 * kMm, 1.0};
  const Vec3 world = camera.to_world().point(in_camera);
  const auto projected = project_point(camera, world);
  ASSERT_GT(projected.size(), 3u);
  int met = 0;
  const auto at_depth = [&](const Camera::Path& path) {
    return path.exit.at((1.0 - path.exit.origin.z) / path.exit.direction.z);
  };
  for (const PointTruth& t : projected) {
    const int column = static_cast<int>(t.pixel.x), row = static_cast<int>(t.pixel.y);
    if (column > 63 || row > 63) continue;
    const auto at = [&](const char* name) {
      return static_cast<double>(field.layers.at(name).at(column, row));
    };
    const Vec3 origin{at("chief.x"), at("chief.y"), at("chief.z")};
    const Vec3 direction{at("chief.dx"), at("chief.dy"), at("chief.dz")};
    if (std::isnan(origin.x)) continue;
    EXPECT_TRUE(relative(length(direction), 1, 1e-6));
    // The ray of the projection meets the point; the layers hold that of the pixel's middle, single
    // precision (6e-8 of a metre) and the tables' own error of 1e-6.
    const Vec2 middle = camera.lattice().centre(t.lens);
    const Vec2 s = camera.sensor_point(t.pixel.x, t.pixel.y);
    EXPECT_TRUE(within(length(at_depth(camera.trace(s, t.lens, middle)) - in_camera), 0, 1e-9, 1));
    if (!(images.camera().lattice().nearest(s) == t.lens)) continue;  // of a neighbour's pixel
    const Camera::Path path =
        camera.trace(camera.sensor_point(column + 0.5, row + 0.5), t.lens, middle);
    const Vec3 exact = camera.to_world().point(at_depth(path)), offset = exact - origin;
    EXPECT_TRUE(
        within(length(offset - dot(offset, direction) * direction), 0, 2e-6, length(offset)));
    ++met;
  }
  EXPECT_GE(met, 2);
}

}  // namespace
}  // namespace plenoflame::test::ground_truth_test
