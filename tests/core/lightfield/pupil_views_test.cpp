// Filters over parts of the stop: what their light adds up to, which views see them, and the
// temperature of a flame from two of them in one picture.
#include "plenoflame/lightfield/pupil_views.h"

#include <cmath>

#include "plenoflame/base/error.h"
#include "plenoflame/lightfield/pyrometry.h"
#include "plenoflame/render/render.h"
#include "plenoflame/scene/spectral.h"
#include "support/approx.h"
#include "support/cameras.h"
#include "support/small_scene.h"

namespace plenoflame::test::pupil_views_test {
namespace {

const double kPi = std::acos(-1.0);

/// The right and the left half of the stop.
std::vector<PupilFilterSpec> halves(const std::string& right, const std::string& left) {
  PupilFilterSpec a{"right"}, b{"left"};
  a.angle = -kPi / 2;
  b.angle = kPi / 2;
  a.extent = b.extent = kPi;
  a.transmission = right;
  b.transmission = left;
  return {a, b};
}

/// A camera whose microlenses image the stop rather sharply, so that pixels see one filter alone.
Scene scene_with(const std::vector<PupilFilterSpec>& filters, LensModel model) {
  ArraySpec array = large_array(Lattice::square, model);
  array.diameter = 0.6e-3;
  array.sensor_distance = 2.36e-3;
  Scene scene = small_scene(model == LensModel::real ? singlet() : ideal_singlet(), array);
  scene.camera.sensor = {120, 120, 50e-6};
  scene.channels = {{"grey", ChannelKind::band, 700e-9, 300e-9}};
  scene.camera.pupil_filters = filters;
  return scene;
}

RenderSettings settings_for(int samples) {
  RenderSettings settings;
  settings.samples = samples;
  settings.control_variate = false;
  return settings;
}

Image picture_of(const Scene& scene) {
  return render(compile(scene), settings_for(64), one_thread()).light_field.channels[0].flux;
}

TEST(PupilFilters, PartsAddUpToTheOpenPupil) {
  // A filter that lets nothing of the channel through, beside one that lets everything through.
  const std::string dark = "100 nm 1, 200 nm 1";
  for (const LensModel model : {LensModel::real, LensModel::ideal}) {
    const Image open = picture_of(scene_with({}, model));
    const Image right = picture_of(scene_with(halves("", dark), model));
    const Image left = picture_of(scene_with(halves(dark, ""), model));
    double largest = 0, only_right = 0, only_left = 0;
    for (std::size_t i = 0; i < open.pixels.size(); ++i) {
      largest = std::max(largest, static_cast<double>(open.pixels[i]));
      only_right += static_cast<double>(right.pixels[i]);
      only_left += static_cast<double>(left.pixels[i]);
    }
    for (std::size_t i = 0; i < open.pixels.size(); ++i)
      ASSERT_TRUE(within(static_cast<double>(right.pixels[i]) + static_cast<double>(left.pixels[i]),
                         static_cast<double>(open.pixels[i]), 1e-6, largest));
    EXPECT_GT(only_right, 0.3 * (only_right + only_left));
    EXPECT_GT(only_left, 0.3 * (only_right + only_left));
  }
}

// A curve that is constant over the channel is a factor.
TEST(PupilFilters, HalfTransmissionIsHalfTheLight) {
  const std::string half = "300 nm 0.5, 1200 nm 0.5";
  const Image open = picture_of(scene_with({}, LensModel::real));
  const Image dimmed = picture_of(scene_with(halves(half, half), LensModel::real));
  double largest = 0;
  for (const float value : open.pixels) largest = std::max(largest, static_cast<double>(value));
  for (std::size_t i = 0; i < open.pixels.size(); ++i)
    // The light of a band is a closed form, that behind a curve a quadrature.
    ASSERT_TRUE(within(static_cast<double>(dimmed.pixels[i]),
                       0.5 * static_cast<double>(open.pixels[i]), 1e-5, largest));
}

/// A ball of hot gas that fills the picture and is opaque, all of one temperature.
FlameSpec hot_ball(double temperature) {
  FlameSpec flame;
  flame.position = {1, 0, 0};
  flame.layers = {{"ball", {0, 0, 0}, {0.1, 0.1, 0.1}, temperature, 2000}};
  return flame;
}

TEST(PupilPyrometry, TemperatureOfOnePicture) {
  const std::string red = "640 nm 0, 650 nm 0.9, 660 nm 0", blue = "540 nm 0, 560 nm 0.7, 570 nm 0";
  for (const double temperature : {1300.0, 1900.0})
    for (const LensModel model : {LensModel::real, LensModel::ideal}) {
      Scene scene = scene_with(halves(red, blue), model);
      scene.flames = {hot_ball(temperature)};
      const LightField field = render(compile(scene), settings_for(256), one_thread()).light_field;
      const MicroImages micro{Camera(scene.camera)};
      const std::vector<PupilView> views = extract_pupil_views(field, micro);
      ASSERT_EQ(views.size(), 2u);
      EXPECT_EQ(views[0].filter, "right");
      EXPECT_GT(views[0].pixels, 10);
      const auto first = camera_response(scene, scene.channels[0], red);
      const auto second = camera_response(scene, scene.channels[0], blue);
      const TemperatureMap map =
          two_colour_map(views[0].light, views[1].light, TwoColour(*first, *second, {}));
      EXPECT_GT(map.pixels, 16u);
      EXPECT_TRUE(relative(map.mean, temperature, 1e-3))
          << map.mean << (model == LensModel::real ? " real" : " ideal") << blur_of_stop(micro, 0)
          << " " << views[0].pixels;
    }
}

// View (column, row) is what the scene looks like from there on the main lens.
TEST(PupilFilters, ViewsOfEachSideSeeItsFilter) {
  for (const LensModel model : {LensModel::real, LensModel::ideal}) {
    const Scene scene = scene_with(halves("", ""), model);
    const MicroImages micro(Camera(scene.camera), false);
    const std::vector<int> parts = parts_of_views(micro, 7, 0.7);
    for (int row = 1; row < 6; ++row) {  // in the corners a view sees the stop's rim
      EXPECT_EQ(parts[static_cast<std::size_t>(7 * row)], 1) << row;       // left
      EXPECT_EQ(parts[static_cast<std::size_t>(7 * row + 6)], 0) << row;   // right
      EXPECT_EQ(parts[static_cast<std::size_t>(7 * row + 3)], -1) << row;  // both
    }
    Scene lower = scene;
    for (PupilFilterSpec& filter : lower.camera.pupil_filters) filter.angle += kPi / 2;
    const MicroImages turned(Camera(lower.camera), false);
    const std::vector<int> below = parts_of_views(turned, 7, 0.7);
    EXPECT_EQ(below[3], 1);          // above
    EXPECT_EQ(below[7 * 6 + 3], 0);  // below
  }
}

TEST(PupilFilters, AFilterThatNoPixelSeesAlone) {
  Scene scene = scene_with(halves("", ""), LensModel::real);
  scene.camera.pupil_filters[0].inner = 0.95;
  LightField field;
  field.unit = "W";
  field.sensor_width = field.sensor_height = 120;
  field.window = {0, 0, 120, 120};
  field.channels = {{"grey", Image(120, 120), {}}};
  const MicroImages micro{Camera(scene.camera)};
  try {
    static_cast<void>(extract_pupil_views(field, micro));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).substr(0, 41),
              "no pixel sees pupil filter \"right\" alone:")
        << error.what();
  }
}

}  // namespace
}  // namespace plenoflame::test::pupil_views_test
