#include "plenoflame/lightfield/views.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "plenoflame/base/error.h"
#include "plenoflame/lightfield/refocus.h"
#include "support/approx.h"
#include "support/cameras.h"

namespace plenoflame::views_test {
namespace {

using test::relative;

/// A raw image made by hand of a square array: micro-image (q, r) holds a value of its own.
class PaintedViews : public ::testing::Test {
 protected:
  PaintedViews() : camera(spec()), micro(camera, false, test::one_thread()) {
    field.sensor_width = camera.spec().sensor.columns;
    field.sensor_height = camera.spec().sensor.rows;
    field.window = {0, 0, field.sensor_width, field.sensor_height};
    field.channels.push_back({"total", Image(field.sensor_width, field.sensor_height), {}});
    settings.white_correction = false;
    settings.grid = 3;
  }
  static CameraSpec spec() {
    CameraSpec camera = test::preset_camera("paper-previous-60x60");
    camera.sensor.columns = camera.sensor.rows = 200;
    return camera;
  }
  Camera camera;
  MicroImages micro;
  LightField field;
  ViewSettings settings;
};

// A colour painted at a place of the upright raw image turns up at the same place of the views.
TEST_F(PaintedViews, AreUpright) {
  // The lens whose micro-image is nearest to column 150, row 40: right of and above the middle.
  const Vec2 s = camera.sensor_point(150, 40);
  const LensIndex lens = camera.lattice().nearest(s);
  const Vec2 centre = micro.place(lens).centre;
  const double p = camera.spec().sensor.pixel_pitch;
  for (int row = 0; row < 200; ++row)
    for (int column = 0; column < 200; ++column)
      if (length(camera.sensor_point(column + 0.5, row + 0.5) - centre) < 5 * p)
        field.channels[0].flux.at(column, row) = 7;
  settings.resampling = ViewResampling::nearest;
  const Views views = extract_views(field, micro, settings, test::one_thread());
  const Image& middle = views.views[4].image;
  EXPECT_TRUE(relative(views.lens_step, 1e-3, 1e-12));
  int bright = 0;
  for (int row = 0; row < middle.height; ++row)
    for (int column = 0; column < middle.width; ++column)
      if (middle.at(column, row) > 6) {
        ++bright;
        EXPECT_LE(std::abs(column - 0.75 * middle.width), 1.0);
        EXPECT_LE(std::abs(row - 0.2 * middle.height), 1.0);
      }
  EXPECT_EQ(bright, 1);
}

// A raw image that is linear in the upright coordinates: bilinear sampling is exact, so that the
// difference of two views is the gradient times the difference of their offsets.
TEST_F(PaintedViews, SampleAtSubPixelOffsets) {
  for (int row = 0; row < 200; ++row)
    for (int column = 0; column < 200; ++column)
      field.channels[0].flux.at(column, row) = static_cast<float>(2 * column + 3 * row);
  const Views views = extract_views(field, micro, settings, test::one_thread());
  const View& middle = views.views[4];
  EXPECT_EQ(middle.offset, (Vec2{0, 0}));
  const double step = views.views[5].offset.x;
  EXPECT_TRUE(relative(step, 0.7 * 2.0 / 3 * micro.place({0, 0}).radius / 100e-6, 1e-3));
  for (const View& view : views.views) {
    EXPECT_TRUE(test::within(view.offset.x, (view.column - 1) * step, 1e-9, step));
    EXPECT_TRUE(test::within(view.offset.y, (view.row - 1) * step, 1e-9, step));
    for (const int column : {3, 9, 14}) {
      const double difference =
          static_cast<double>(view.image.at(column, 6) - middle.image.at(column, 6));
      EXPECT_TRUE(test::within(difference, 2 * view.offset.x + 3 * view.offset.y, 1e-4, 10));
    }
  }
}

TEST_F(PaintedViews, BadSettingsAreRefused) {
  settings.grid = 0;
  EXPECT_THROW(extract_views(field, micro, settings), InputError);
  settings.grid = 3;
  settings.spread = 1.5;
  EXPECT_THROW(extract_views(field, micro, settings), InputError);
  settings.spread = 0.7;
  settings.resampling = ViewResampling::paper9;
  EXPECT_THROW(extract_views(field, micro, settings), InputError);
  settings.resampling = ViewResampling::nearest;
  settings.channel = "red";
  EXPECT_THROW(extract_views(field, micro, settings), InputError);
}

// Views of one type see nothing of the other types' light, and a picture that is linear in place
// stays that.
TEST(Views, OfOneType) {
  CameraSpec spec = test::preset_camera("raytrix-r29-reduced");
  spec.sensor.columns = spec.sensor.rows = 600;
  const Camera camera(spec);
  const MicroImages micro(camera, false, test::threads(2));
  for (const int type : {0, 1, 2}) {
    LightField field;
    field.sensor_width = field.sensor_height = 600;
    field.window = {0, 0, 600, 600};
    field.channels.push_back({"total", Image(600, 600), {}});
    for (int row = 0; row < 600; ++row)
      for (int column = 0; column < 600; ++column) {
        const Vec2 s = camera.sensor_point(column + 0.5, row + 0.5);
        const LensIndex lens = camera.lattice().nearest(s);
        const bool ours = camera.lattice().type(lens) == type;
        const double flat = 1000 + lens.q * 3 - 7 * lens.r;
        field.channels[0].flux.at(column, row) = static_cast<float>(ours ? flat : 1e6);
      }
    ViewSettings settings;
    settings.grid = 1;
    settings.type = type;
    settings.white_correction = false;
    const Views views = extract_views(field, micro, settings, test::one_thread());
    const Image& image = views.views[0].image;
    EXPECT_TRUE(
        relative(views.lens_step, std::sqrt(3.0) * std::pow(0.75, 0.25) * spec.array.pitch, 1e-9));
    // lens.q, lens.r of a point of the array, from the lattice's definition.
    const double pitch = spec.array.pitch;
    const double step = views.lens_step / pitch;
    const auto at = [&](int column, int row) { return static_cast<double>(image.at(column, row)); };
    const double r_step = step / std::sqrt(0.75);
    for (int row = 2; row + 2 < image.height; ++row)
      for (int column = 2; column + 2 < image.width; ++column) {
        // Right and down in the picture are -x and -y of the array.
        EXPECT_TRUE(test::within(at(column + 1, row) - at(column, row), -3 * step, 1e-3, 1));
        EXPECT_TRUE(test::within(at(column, row + 1) - at(column, row),
                                 7 * r_step + 3 * 0.5 * r_step, 1e-3, 1));
        EXPECT_LT(at(column, row), 2000);
      }
  }
}

TEST_F(PaintedViews, ContactSheetHoldsEveryView) {
  for (int row = 0; row < 200; ++row)
    for (int column = 0; column < 200; ++column)
      field.channels[0].flux.at(column, row) = static_cast<float>(column + 1000 * row);
  const Views views = extract_views(field, micro, settings, test::one_thread());
  const Image sheet = contact_sheet(views);
  const View& view = views.views[5];
  EXPECT_EQ(sheet.width, 3 * view.image.width + 2);
  EXPECT_EQ(sheet.at(2 * (view.image.width + 1) + 4, view.image.height + 1 + 7),
            view.image.at(4, 7));
}

// Whoever watches sees shares of the work that rise to 1, of each step.
TEST_F(PaintedViews, ReportTheirProgress) {
  std::vector<double> shares;
  Execution watched = test::one_thread();
  watched.progress = [&](const Progress& progress) { shares.push_back(progress.fraction); };
  const auto expect_shares = [&](const char* what) {
    EXPECT_GT(shares.size(), 3u) << what;
    EXPECT_TRUE(std::ranges::is_sorted(shares)) << what;
    EXPECT_EQ(shares.empty() ? 0 : shares.back(), 1) << what;
    shares.clear();
  };
  const MicroImages again(camera, false, watched);
  expect_shares("micro-images");
  extract_views(field, micro, settings, watched);
  expect_shares("views");
  RefocusSettings plane;
  plane.depth = 1;
  refocus(field, micro, plane, watched);
  expect_shares("a plane");
  focus_stack(field, micro, {0.9, 1, 1.1}, {}, watched);
  expect_shares("a stack of planes");
}

}  // namespace
}  // namespace plenoflame::views_test
