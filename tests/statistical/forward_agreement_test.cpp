// The two estimators share no sampling code: what they agree on is right, or wrong in the medium or
// the lens surfaces, which have tests of their own.
#include <gtest/gtest.h>

#include "core/media_voxel/voxel_fixture.h"
#include "plenoflame/media/voxel_medium.h"
#include "plenoflame/scene/spectral.h"
#include "statistical/agreement.h"
#include "support/small_scene.h"

namespace plenoflame::test::forward_agreement_test {
namespace {

TEST(ForwardAgreement, HexagonalArrayOfThreeTypes) {
  expect_agreement(small_scene(singlet(), large_array(Lattice::hexagonal, LensModel::real)));
}

// Displaced microlenses, turned and shifted, with the sensor too far away.
TEST(ForwardAgreement, ArrayWithTolerances) {
  Scene scene = small_scene(singlet(), large_array(Lattice::hexagonal, LensModel::real));
  ArraySpec& array = scene.camera.array;
  array.diameter *= 0.85;
  array.centre_jitter = 0.45 * (array.pitch - array.diameter);
  array.rotation = 0.05;
  array.offset = {0.1 * array.pitch, -0.2 * array.pitch};
  array.spacing_error = 0.05 * array.sensor_distance;
  expect_agreement(scene);
}

// Nothing is where it should be: a tilted array of lenses with focal lengths of their own behind a
// main lens that is decentred and tilted.
TEST(ForwardAgreement, MisalignedCamera) {
  const auto misalign = [](Scene& scene) {
    scene.camera.lens.decentre = {0.6e-3, -0.9e-3};
    scene.camera.lens.tilt = {0.004, 0.006};
    scene.camera.array.tilt = {0.05, -0.03};
    scene.camera.array.focal_jitter = 0.08;
  };
  for (const LensModel model : {LensModel::real, LensModel::ideal}) {
    Scene scene = small_scene(model == LensModel::real ? singlet() : ideal_singlet(),
                              large_array(Lattice::hexagonal, model));
    misalign(scene);
    expect_agreement(scene);
  }
  Scene bare = small_scene(singlet(), {});
  misalign(bare);
  expect_agreement(bare);
  Scene clear = small_scene(singlet(), large_array(Lattice::square, LensModel::real));
  clear.camera.array.diameter *= 0.7;
  clear.camera.array.opaque_between = false;
  misalign(clear);
  expect_agreement(clear);
}

// A plano-convex lens with a hyperbolic and an even aspheric face.
TEST(ForwardAgreement, AsphericLens) {
  MainLensSpec lens = singlet();
  lens.surfaces[0].conic = -0.8;
  lens.surfaces[1].conic = 0.5;
  lens.surfaces[1].aspheric = {1.2, 0, -900};
  expect_agreement(small_scene(lens, large_array(Lattice::hexagonal, LensModel::real)));
}

/// The small scene's lens with a front of two radii, whose focal lengths differ by a third.
MainLensSpec anamorphic() {
  MainLensSpec lens = singlet();
  SurfaceSpec& front = lens.surfaces[0];
  front.radius = kInfinity;
  front.radius_x = 0.24, front.radius_y = 0.45;
  front.conic_x = -0.6;
  return lens;
}

// Nothing is round, and pupils are not tabulated: with arrays of every kind, without, and where it
// is mounted askew on top of that.
TEST(ForwardAgreement, LensThatIsNotRound) {
  expect_agreement(small_scene(anamorphic(), large_array(Lattice::hexagonal, LensModel::real)));
  expect_agreement(small_scene(anamorphic(), large_array(Lattice::square, LensModel::ideal)));
  expect_agreement(small_scene(anamorphic(), {}));
  ArraySpec array = large_array(Lattice::square, LensModel::real);
  array.aperture = ApertureShape::square;
  array.diameter *= 0.7;
  array.opaque_between = false;
  array.tilt = {0.05, -0.03};
  array.focal_jitter = 0.08;
  Scene scene = small_scene(anamorphic(), array);
  scene.camera.lens.decentre = {0.6e-3, -0.9e-3};
  scene.camera.lens.tilt = {0.004, 0.006};
  expect_agreement(scene);
}

// A cylinder alone behind the stop, which is in front: rays of one section go straight on.
TEST(ForwardAgreement, Cylinder) {
  MainLensSpec lens = singlet();
  lens.surfaces = {{kInfinity, 0.01, 1, 0.06, true},
                   {kInfinity, 0.02426, 1.5, 0.12, false},
                   {-0.3, 0, 1, 0.12, false}};
  lens.surfaces[1].radius_x = kInfinity;
  lens.surfaces[1].radius_y = 0.3;
  // It blurs the flame far across: few of a pixel's rays find it.
  expect_agreement(small_scene(lens, large_array(Lattice::square, LensModel::real)),
                   load_core_medium, kBundles, 4 * kRaysPerReplicate);
}

TEST(ForwardAgreement, SquareArray) {
  expect_agreement(small_scene(singlet(), large_array(Lattice::square, LensModel::real)));
}

TEST(ForwardAgreement, IdealLensAndArray) {
  expect_agreement(small_scene(ideal_singlet(), large_array(Lattice::hexagonal, LensModel::ideal)));
}

TEST(ForwardAgreement, IdealLensRealArray) {
  expect_agreement(small_scene(ideal_singlet(), large_array(Lattice::square, LensModel::real)));
}

// The front surface itself limits the beam; and a stop so far behind the lens that the entrance
// pupil lies beyond the flame.
TEST(ForwardAgreement, ApertureAtTheFrontOrBeyondTheFlame) {
  MainLensSpec lens = singlet();
  lens.surfaces = {{kInfinity, 0.01, 1, 0.06, true},
                   {0.3, 0.02426, 1.5, 0.12, false},
                   {-0.3, 0, 1, 0.12, false}};
  expect_agreement(small_scene(lens, large_array(Lattice::square, LensModel::real)));
  lens = ideal_singlet();
  lens.surfaces[1].thickness = 0.31;
  lens.surfaces[2].diameter = 0.03;
  expect_agreement(small_scene(lens, large_array(Lattice::square, LensModel::real)));
}

TEST(ForwardAgreement, WithoutArray) {
  expect_agreement(small_scene(singlet(), {}));
  expect_agreement(small_scene(ideal_singlet(), {}));
}

// Micro-images of 1.6 mm behind lenses of 1 mm: pixels receive light through several.
TEST(ForwardAgreement, Crosstalk) {
  ArraySpec array = large_array(Lattice::hexagonal, LensModel::real);
  array.sensor_distance = 4e-3;
  expect_agreement(small_scene(singlet(), array));
}

// Clear between lenses that leave much of the array to straight rays.
TEST(ForwardAgreement, ClearBetweenTheLenses) {
  for (const LensModel model : {LensModel::real, LensModel::ideal}) {
    ArraySpec array = large_array(Lattice::square, model);
    array.diameter = 0.7 * array.pitch;
    expect_agreement(small_scene(singlet(), array));
    array.opaque_between = false;
    expect_agreement(small_scene(singlet(), array));
  }
}

// Lenses with sides, without gaps: hexagons in a lattice that is turned, of real and ideal lenses;
// rectangles, whose circles would overlap; and smaller squares with clear air between them.
TEST(ForwardAgreement, LensesWithSides) {
  for (const LensModel model : {LensModel::real, LensModel::ideal}) {
    ArraySpec array = large_array(Lattice::hexagonal, model);
    array.aperture = ApertureShape::hexagonal;
    expect_agreement(small_scene(singlet(), array));
  }
  ArraySpec array = large_array(Lattice::square, LensModel::real);
  array.aperture = ApertureShape::square;
  array.pitch_y = array.diameter_y = 0.7e-3;
  array.rotation = 0.3;
  expect_agreement(small_scene(singlet(), array));
  array.diameter = 0.7e-3;
  array.diameter_y = 0.5e-3;
  array.opaque_between = false;
  expect_agreement(small_scene(singlet(), array));
}

// The same where nothing stands as it should.
TEST(ForwardAgreement, MisalignedLensesWithSides) {
  for (const LensModel model : {LensModel::real, LensModel::ideal}) {
    ArraySpec array = large_array(Lattice::square, model);
    array.aperture = ApertureShape::square;
    array.tilt = {0.05, -0.03};
    array.focal_jitter = 0.08;
    Scene scene = small_scene(singlet(), array);
    scene.camera.lens.decentre = {0.6e-3, -0.9e-3};
    expect_agreement(scene);
  }
}

// An array with an edge inside of the sensor, opaque and clear beyond it.
TEST(ForwardAgreement, FewMicrolenses) {
  for (const bool opaque : {true, false}) {
    ArraySpec array = large_array(Lattice::hexagonal, LensModel::real);
    array.columns = 4;
    array.rows = 5;
    array.opaque_between = opaque;
    expect_agreement(small_scene(singlet(), array));
  }
}

/// Two bands behind three filters: halves of a ring that share a band, and a square in the middle;
/// the rest of the stop is open.
std::vector<PupilFilterSpec> three_filters() {
  PupilFilterSpec right{"right", PupilPartShape::sector};
  right.angle = -0.5;
  right.extent = 3;
  right.inner = 0.6;
  right.transmission = "600 nm 0.2, 700 nm 0.9";
  PupilFilterSpec left = right;
  left.name = "left";
  left.angle = 2.5;
  left.extent = 2.9;
  left.transmission = "440 nm 0.8, 660 nm 0.1";
  PupilFilterSpec middle{"middle", PupilPartShape::polygon};
  middle.corners = {{-0.3, -0.2}, {0.4, -0.2}, {0.4, 0.3}, {-0.3, 0.3}};
  middle.transmission = "440 nm 1, 470 nm 1";
  return {right, left, middle};
}

TEST(ForwardAgreement, FiltersInThePupil) {
  for (const LensModel model : {LensModel::real, LensModel::ideal}) {
    Scene scene = small_scene(model == LensModel::real ? singlet() : ideal_singlet(),
                              large_array(Lattice::square, LensModel::real));
    scene.channels = {{"red", ChannelKind::band, 650e-9, 40e-9},
                      {"blue", ChannelKind::band, 450e-9, 10e-9}};
    scene.camera.pupil_filters = three_filters();
    expect_agreement(scene);
    // Absorption by wavelength, and a lens that disperses: every wavelength goes its own way.
    scene.flames[0].spectrum.kind = SpectrumKind::soot;
    expect_agreement(scene);
    if (model == LensModel::ideal) continue;
    scene.camera.lens.surfaces[0].glass = "N-SF11";
    expect_agreement(scene);
  }
}

// A flame nearer than the focus, off the axis, and a camera that stands and looks elsewhere.
TEST(ForwardAgreement, NearFlameAndTurnedCamera) {
  Scene scene = small_scene(singlet(), large_array(Lattice::hexagonal, LensModel::real));
  scene.camera.position = {0.2, 0.3, -0.1};
  scene.camera.look_direction = {1, -1, 0.5};
  scene.camera.focus.object_distance = 0.5;
  scene.camera.sensor.pixel_pitch = 0.6e-3;
  scene.flames[0].position = {0.2 + 0.3, 0.3 - 0.3, -0.1 + 0.15 - 0.005};
  expect_agreement(scene);
}

// Two channels that differ in what they see: nearly all of the second comes from the hot layer.
TEST(ForwardAgreement, TwoChannels) {
  Scene scene = small_scene(singlet(), large_array(Lattice::square, LensModel::real));
  scene.channels.push_back({"blue", ChannelKind::band, 400e-9, 10e-9});
  expect_agreement(scene);
}

// Soot, for which several wavelengths stand for each channel of a colour camera.
TEST(ForwardAgreement, SootInColour) {
  Scene scene = small_scene(singlet(), large_array(Lattice::square, LensModel::real));
  scene.flames[0].spectrum.kind = SpectrumKind::soot;
  scene.channels = {{"red", ChannelKind::named, 0, 0, "nikon_d5100_red"},
                    {"blue", ChannelKind::named, 0, 0, "nikon_d5100_blue"}};
  expect_agreement(scene);
}

// Reflection at all surfaces, with a coating, which disperses, and a cover glass.
TEST(ForwardAgreement, ReflectionsAndDispersion) {
  Scene scene = small_scene(singlet(), large_array(Lattice::hexagonal, LensModel::real));
  scene.camera.transmission.fresnel = true;
  scene.camera.transmission.coating_index = 1.8;
  scene.camera.transmission.cover_index = 1.6;
  scene.camera.lens.surfaces[0].glass = "N-SF11";
  scene.channels = {{"red", ChannelKind::band, 700e-9, 10e-9},
                    {"blue", ChannelKind::band, 450e-9, 10e-9}};
  expect_agreement(scene);
}

// At an asphere and through a tilted lens and array the angles of incidence are others.
TEST(ForwardAgreement, ReflectionsOfAMisalignedAsphericCamera) {
  MainLensSpec lens = singlet();
  lens.surfaces[0].conic = -0.8;
  lens.surfaces[1].aspheric = {1.2, 0, -900};
  Scene scene = small_scene(lens, large_array(Lattice::square, LensModel::real));
  scene.camera.transmission.fresnel = true;
  scene.camera.transmission.cover_index = 1.6;
  scene.camera.lens.tilt = {0.004, 0.006};
  scene.camera.array.tilt = {0.05, -0.03};
  scene.camera.array.diameter *= 0.7;
  scene.camera.array.opaque_between = false;
  expect_agreement(scene);
}

/// A smooth, optically thick ball of hot gas around (1 m, 0, 0), on a grid that is turned.
std::unique_ptr<Medium> ball(const std::vector<SourceFunction>& channels,
                             VoxelInterpolation interpolation) {
  AffineTransform map;
  const Mat3 turn = rotation_xyz({0.3, 0.5, -0.2});
  for (std::size_t i = 0; i < 3; ++i) map.linear.rows[i] = 0.5e-3 * turn.rows[i];
  map.translation = {1, 0, 0};
  const auto radius = [](int i, int j, int k) {
    return std::sqrt(static_cast<double>(i * i + j * j + k * k)) / 16;
  };
  const auto temperature = [&](int i, int j, int k) {
    return static_cast<float>(800 + 1100 * std::exp(-3 * std::pow(radius(i, j, k) - 0.4, 2)));
  };
  const auto absorption = [&](int i, int j, int k) {
    const double r = radius(i, j, k);
    return static_cast<float>(r < 1 ? 200 * (1 - r) * (i > 0 ? 1 : 0.3) : 0);
  };
  return make_voxel_medium(make_field({-20, -20, -20}, {20, 20, 20}, temperature, map),
                           make_field({-20, -20, -20}, {20, 20, 20}, absorption, map),
                           interpolation, channels);
}

TEST(ForwardAgreement, VoxelMedium) {
  for (const auto interpolation : {VoxelInterpolation::trilinear, VoxelInterpolation::constant}) {
    Scene scene = small_scene(singlet(), large_array(Lattice::hexagonal, LensModel::real));
    expect_agreement(scene, [&](const FlameSpec&, const std::string&,
                                const std::vector<SourceFunction>& channels,
                                const Execution&) { return ball(channels, interpolation); });
  }
}

// A shell that glows at one wavelength around the ball, partly where nothing absorbs; one channel
// sees the heat alone, one both, one little but the line. Fails when the forward estimator takes
// emission for absorption times the source function.
TEST(ForwardAgreement, EmissionLines) {
  Scene scene = small_scene(singlet(), large_array(Lattice::hexagonal, LensModel::real));
  const LineSpec line{LineKind::custom, 500e-9, 0, {"glow", "W/m^3"}};
  scene.flames[0].kind = FlameKind::vdb;
  scene.flames[0].file = "glow.vdb";
  scene.flames[0].layers.clear();
  scene.flames[0].lines = {line};
  scene.flames[0].spectrum.kind = SpectrumKind::power;
  scene.channels = {{"heat", ChannelKind::band, 650e-9, 10e-9},
                    {"wide", ChannelKind::band, 520e-9, 60e-9},
                    {"blue", ChannelKind::band, 500e-9, 1e-9}};
  expect_agreement(scene, [](const FlameSpec& flame, const std::string&,
                             const std::vector<SourceFunction>& channels, const Execution&) {
    const AffineTransform map = [] {
      AffineTransform made;
      for (std::size_t i = 0; i < 3; ++i)
        made.linear.rows[i] = {i == 0 ? 0.5e-3 : 0, i == 1 ? 0.5e-3 : 0, i == 2 ? 0.5e-3 : 0};
      made.translation = {1, 0, 0};
      return made;
    }();
    const auto radius = [](int i, int j, int k) {
      return std::sqrt(static_cast<double>(i * i + j * j + k * k)) / 16;
    };
    const auto field = [&](const auto& value, float background) {
      return make_field({-24, -24, -24}, {24, 24, 24}, value, map, background);
    };
    VoxelMediumOptions options;
    options.absorption_factors = absorption_factors(flame.spectrum, channels);
    options.extras.lines = {field(
        [&](int i, int j, int k) {
          const double r = (radius(i, j, k) - 0.9) / 0.2;
          return static_cast<float>(i + j > 4 && r * r < 4 ? 900 * std::exp(-r * r) : 0);
        },
        0)};
    options.extras.line_weights = line_weights(flame, channels);
    return make_voxel_medium(
        field([](int, int, int) { return 1700.0f; }, 300),
        field([&](int i, int j, int k) { return radius(i, j, k) < 0.8 ? 60.0f : 0.0f; }, 0),
        VoxelInterpolation::trilinear, channels, options);
  });
}

}  // namespace
}  // namespace plenoflame::test::forward_agreement_test
