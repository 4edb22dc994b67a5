#include "plenoflame/lightfield/micro_images.h"

#include <gtest/gtest.h>

#include <cmath>

#include "plenoflame/base/error.h"
#include "support/approx.h"
#include "support/cameras.h"
#include "support/isas.h"
#include "support/plain_sampler.h"

namespace plenoflame::micro_images_test {
namespace {

using test::relative;
using test::within;

/// Thin ideal main lens (f = 0.1 m, 25 mm) with a thin ideal array: everything has a closed form.
CameraSpec thin_camera() {
  CameraSpec camera;
  camera.lens.model = LensModel::ideal;
  camera.lens.focal_length = 0.1;
  camera.lens.diameter = 0.025;
  camera.array.present = true;
  camera.array.lattice = Lattice::square;
  camera.array.model = LensModel::ideal;
  camera.array.pitch = camera.array.diameter = 200e-6;
  MicrolensSpec lens;
  lens.name = "type1";
  lens.focal_length = 1e-3;
  camera.array.types = {lens};
  camera.array.sensor_distance = 1e-3;
  camera.sensor = {400, 300, 10e-6};
  camera.focus.mode = FocusMode::paraxial;
  camera.focus.object_distance = 1;
  return camera;
}

// Similar triangles: the stop's middle, the microlens' middle and the point on the sensor.
TEST(MicroImages, CentresAndRadiiOfAThinCamera) {
  const Camera camera(thin_camera());
  const MicroImages micro(camera, false, test::one_thread());
  const double distance = 1 / (1 / 0.1 - 1 / 1.0), gap = 1e-3;
  EXPECT_TRUE(relative(camera.lens_distance(), distance, 1e-12));
  for (const LensIndex lens :
       {LensIndex{0, 0}, LensIndex{5, 2}, LensIndex{-7, 3}, LensIndex{9, -7}}) {
    const MicroImages::Place place = micro.place(lens);
    ASSERT_FALSE(place.dark);
    const double scale = 1 + gap / distance;
    EXPECT_TRUE(within(place.centre.x, lens.q * 200e-6 * scale, 1e-3, 10e-6)) << lens.q;
    EXPECT_TRUE(within(place.centre.y, lens.r * 200e-6 * scale, 1e-3, 10e-6)) << lens.r;
    EXPECT_TRUE(relative(place.radius, 0.5 * 0.025 * gap / distance, 3e-3));
  }
  EXPECT_TRUE(relative(micro.spacing(), 200e-6 * (1 + gap / distance), 1e-4));
}

// All chief rays of a microlens meet where the main lens images its middle: X = -x (1 m) /
// distance.
TEST(MicroImages, ChiefRaysMeetTheImageOfTheMicrolens) {
  const Camera camera(thin_camera());
  const MicroImages micro(camera, false, test::one_thread());
  const double distance = 1 / (1 / 0.1 - 1 / 1.0);
  for (const LensIndex lens : {LensIndex{4, -3}, LensIndex{-9, 6}}) {
    const MicroImages::Place place = micro.place(lens);
    const Vec2 expected{-lens.q * 200e-6 / distance, -lens.r * 200e-6 / distance};
    const MicroImages::ToPlane plane = micro.to_plane(place, 1.0);
    for (const Vec2 u : {Vec2{0, 0}, Vec2{0.9, 0}, Vec2{-0.5, 0.6}, Vec2{0.1, -0.95}}) {
      const Vec2 point = plane(place.centre + place.radius * u);
      EXPECT_TRUE(within(point.x, expected.x, 1e-4, 200e-6 / distance));
      EXPECT_TRUE(within(point.y, expected.y, 1e-4, 200e-6 / distance));
      // At the front vertex the ray is where it crosses the stop: opposite to the sensor point.
      const MicroImages::Line line = micro.chief_ray(place, place.centre + place.radius * u);
      EXPECT_TRUE(within(line.position.x, -0.0125 * u.x, 4e-3, 0.0125));
      EXPECT_TRUE(within(line.position.y, -0.0125 * u.y, 4e-3, 0.0125));
    }
  }
}

// Against the camera's own trace, through real glass.
TEST(MicroImages, ChiefRaysAreThoseOfTheRealCamera) {
  for (const char* name : {"paper-plenoptic1", "raytrix-r29-reduced"}) {
    const Camera camera(test::preset_camera(name));
    const MicroImages micro(camera, false, test::threads(2));
    int compared = 0;
    for (const Vec2 at :
         {Vec2{0, 0}, Vec2{0.003, -0.002}, Vec2{-0.005, 0.0045}, Vec2{0.0001, 0.006}}) {
      const LensIndex lens = camera.lattice().nearest(at);
      const MicroImages::Place place = micro.place(lens);
      ASSERT_FALSE(place.dark) << name;
      for (const Vec2 u : {Vec2{0, 0}, Vec2{0.8, 0.1}, Vec2{-0.3, 0.7}, Vec2{-0.6, -0.6}}) {
        const Vec2 s = place.centre + place.radius * u;
        const Camera::Path path = camera.trace(s, lens, camera.lattice().centre(lens));
        if (path.status.status != RayStatus::reached) continue;
        ++compared;
        const Ray& ray = path.exit;
        const Vec3 hit = ray.at((1.2 - ray.origin.z) / ray.direction.z);
        const Vec2 found = micro.to_plane(place, 1.2)(s);
        // Within 30 um at 1.2 m, a hundredth of what a microlens covers there.
        EXPECT_LT(length(found - Vec2{hit.x, hit.y}), 30e-6) << name << ' ' << u.x << ' ' << u.y;
      }
    }
    EXPECT_GE(compared, 12) << name;
  }
}

// Plain sampling of the measurement equation shares neither tables nor quadrature.
TEST(MicroImages, WhiteIsTheEtendueOfThePixel) {
  const Camera camera(test::preset_camera("raytrix-r29-reduced"));
  const MicroImages micro(camera, true, test::threads(2));
  test::PlainSampler sampler(camera, 5);
  for (const Vec2 at : {Vec2{0, 0}, Vec2{0.006, -0.003}}) {
    const MicroImages::Place place = micro.place(camera.lattice().nearest(at));
    const double p = camera.spec().sensor.pixel_pitch;
    const SensorSpec& sensor = camera.spec().sensor;
    const double column = std::floor(0.5 * sensor.columns - place.centre.x / p);
    const double row = std::floor(0.5 * sensor.rows - place.centre.y / p);
    const auto estimate = sampler.flux(column, row, 1, 1, 200000);
    const double white = micro.white(place, camera.sensor_point(column + 0.5, row + 0.5));
    EXPECT_LT(estimate.standard_error, 0.01 * estimate.flux);
    EXPECT_LT(std::fabs(white - estimate.flux), 0.005 * white + 4 * estimate.standard_error)
        << white << ' ' << estimate.flux;
  }
}

// The same of pixels that are not square, at the rims of micro-images in all directions from the
// axis, where their shape shows.
TEST(MicroImages, WhiteOfOblongPixelsIsTheirEtendue) {
  CameraSpec spec = test::preset_camera("raytrix-r29-reduced");
  spec.sensor.pixel_pitch_y = 2.5 * spec.sensor.pixel_pitch;
  const Camera camera(spec);
  const MicroImages micro(camera, true, test::threads(2));
  test::PlainSampler sampler(camera, 5);
  for (const Vec2 at : {Vec2{0, 0}, Vec2{0.006, -0.003}, Vec2{-0.002, 0.007}}) {
    const MicroImages::Place place = micro.place(camera.lattice().nearest(at));
    for (const Vec2 rim : {Vec2{0, 0}, Vec2{1, 0}, Vec2{0, 1}, Vec2{-0.7, 0.7}}) {
      const Vec2 s = place.centre + place.radius * rim;
      const double column = std::floor(0.5 * spec.sensor.columns - s.x / spec.sensor.pixel_pitch);
      const double row = std::floor(0.5 * spec.sensor.rows - s.y / spec.sensor.pixel_pitch_y);
      const auto estimate = sampler.flux(column, row, 1, 1, 200000);
      const MicroImages::LocalWhite whites(micro, place.lens, 2 * place.radius);
      const double white = whites(camera.sensor_point(column + 0.5, row + 0.5)).total;
      EXPECT_LT(estimate.standard_error, 0.02 * estimate.flux);
      EXPECT_LT(std::fabs(white - estimate.flux),
                0.02 * estimate.flux + 4 * estimate.standard_error)
          << white / estimate.flux << " at " << rim.x << ", " << rim.y;
    }
  }
}

// The vector code for all pixels of a micro-image, against the operator in double precision for one
// after the other; also where the light of neighbours arrives.
TEST(MicroImages, PixelsHaveTheWhiteLightOfTheirPlaces) {
  for (const char* name : {"raytrix-r29-reduced", "paper-previous-60x60", "oblong pixels"}) {
    const bool oblong = std::string(name) == "oblong pixels";
    CameraSpec spec = test::preset_camera(oblong ? "raytrix-r29-reduced" : name);
    if (oblong) spec.sensor.pixel_pitch_y = 1.7 * spec.sensor.pixel_pitch;
    const MicroImages micro(Camera(spec), true, test::threads(2));
    const PixelWindow window{3, 5, spec.sensor.columns - 9, spec.sensor.rows - 20};
    const double radius = 0.6 * micro.spacing(), p = spec.sensor.pixel_pitch;
    const double down = oblong ? spec.sensor.pixel_pitch_y : p;
    std::size_t shared_in_all = 0;
    for (const LensIndex lens : {LensIndex{0, 0}, LensIndex{9, -4}, LensIndex{-13, 17}}) {
      const MicroImages::Place place = micro.place(lens);
      ASSERT_FALSE(place.dark);
      const MicroImages::LocalWhite white(micro, lens, radius);
      const double brightest = micro.white(place, place.centre);
      for (const Isa isa : test::supported_isas()) {
        MicroImages::Pixels pixels;
        pixels.set(spec.sensor, window, place.centre, radius);
        white.fill(pixels, isa);
        std::size_t at = 0, shared = 0;
        for (const MicroImages::Pixels::Row& row : pixels.rows) {
          ASSERT_EQ(row.begin, at);
          for (std::size_t k = 0; k < row.count; ++k, ++at) {
            const Vec2 s = micro.camera().sensor_point(row.column + static_cast<double>(k) + 0.5,
                                                       row.row + 0.5);
            ASSERT_LE(length(s - place.centre), radius * (1 + 1e-9));
            EXPECT_TRUE(
                within(-p * static_cast<double>(pixels.x[at]), s.x - place.centre.x, 1e-5, p));
            EXPECT_TRUE(
                within(-down * static_cast<double>(pixels.y[at]), s.y - place.centre.y, 1e-5, p));
            const MicroImages::White expected = white(s);
            EXPECT_TRUE(within(static_cast<double>(pixels.own[at]), expected.own, 2e-5, brightest));
            EXPECT_TRUE(
                within(static_cast<double>(pixels.total[at]), expected.total, 2e-5, brightest))
                << name << ' ' << plenoflame::name(isa);
            shared += expected.total > expected.own ? 1 : 0;
          }
        }
        ASSERT_EQ(pixels.x.size(), at);
        ASSERT_EQ(pixels.own.size(), at);
        // The area of the disc in pixels.
        EXPECT_TRUE(
            relative(static_cast<double>(at), 3.14159265 * radius * radius / (p * down), 0.1));
        shared_in_all += shared;
      }
    }
    EXPECT_GT(shared_in_all, 0U) << name;
  }
}

// A plane-parallel plate displaces what is behind it, by t s (1 - cos i / sqrt(n^2 - sin^2 i)) for
// a ray of the slope s that meets it at the angle i; it does not turn rays.
TEST(MicroImages, PlanesBehindAPlateAreDisplaced) {
  const Camera camera(thin_camera());
  MicroImages micro(camera, false);
  WindowSpec plate;
  plate.position = camera.to_world().point({0, 0, 0.3});
  plate.rotation = {0, 1.5707963267948966, 0};  // along the camera's axis
  plate.thickness = 0.04;
  plate.diameter = 1;
  plate.index = 1.7;
  for (const LensIndex lens : {LensIndex{0, 0}, LensIndex{9, -7}}) {
    const MicroImages::Place place = micro.place(lens);
    ASSERT_FALSE(place.dark);
    for (const Vec2 rim : {Vec2{0, 0}, Vec2{0.9, 0}, Vec2{-0.5, 0.7}}) {
      const Vec2 s = place.centre + place.radius * rim;
      micro.look_through({});
      const MicroImages::Line straight = micro.chief_ray(place, s);
      const double slope2 = dot(straight.slope, straight.slope), cosine2 = 1 / (1 + slope2);
      const double share =
          1 - std::sqrt(cosine2) / std::sqrt(plate.index * plate.index - (1 - cosine2));
      const Vec2 shift = plate.thickness * share * straight.slope;
      micro.look_through({plate});
      for (const double depth : {0.2, 0.8, 5.0}) {
        const Vec2 expected =
            straight.position + depth * straight.slope - (depth > 0.5 ? 1.0 : 0.0) * shift;
        const Vec2 at = micro.to_plane(place, depth)(s);
        EXPECT_LT(length(at - expected), 1e-11 * depth) << depth;
      }
      const MicroImages::Line behind = micro.chief_ray(place, s);
      EXPECT_LT(length(behind.position + shift - straight.position), 1e-11);
      EXPECT_LT(length(behind.slope - straight.slope), 1e-11);
    }
  }
}

TEST(MicroImages, RefusesWhatHasNone) {
  CameraSpec bare = thin_camera();
  bare.array = {};
  bare.focus.conjugate = "sensor";
  EXPECT_THROW(MicroImages{Camera(bare)}, InputError);
  LightField field;
  field.sensor_width = 400;
  field.sensor_height = 300;
  EXPECT_THROW(check_raw_image(field, bare), InputError);
  EXPECT_NO_THROW(check_raw_image(field, thin_camera()));
  field.sensor_width = 399;
  EXPECT_THROW(check_raw_image(field, thin_camera()), InputError);
  field.sensor_width = 400;
  field.unit = "W/(m^2 sr)";
  EXPECT_THROW(check_raw_image(field, thin_camera()), InputError);
}

}  // namespace
}  // namespace plenoflame::micro_images_test
