// The computations in the background. References: the command, sums over rays, closed forms.
#include "model/session.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <random>
#include <set>
#include <thread>
#include <vector>

#include "plenoflame/image/light_field.h"
#include "plenoflame/lightfield/micro_images.h"
#include "plenoflame/media/layered_medium.h"
#include "qt_main.h"
#include "scenes.h"
#include "support/approx.h"
#include "support/temporary_folder.h"

namespace plenoflame::desktop::test {
namespace {

using plenoflame::test::relative;
using plenoflame::test::TemporaryFolder;

/// Samples that nobody waits for: the last passes last minutes, the first ones a blink.
constexpr const char* kEndless = "200000";

class SessionTest : public ::testing::Test {
 protected:
  void open() { session_.document().open_text(small_scene_text(), "small.toml"); }
  bool finish() {
    return wait_for([&] { return session_.render().state() == RenderJob::State::finished; });
  }
  Session session_;
};

TEST_F(SessionTest, FinishedImageIsTheCommandsBitForBit) {
  int pictures = 0;
  QObject::connect(&session_.document(), &Document::image_changed, [&] { ++pictures; });
  open();
  session_.document().set_value("render.samples", "128");
  ASSERT_TRUE(finish());
  EXPECT_GE(pictures, 3);  // coarser ones before
  EXPECT_TRUE(session_.document().image_is_current());
  EXPECT_GT(session_.render().status().rays, 0);
  EXPECT_EQ(session_.render().status().rays, session_.render().statistics().rays);
  const TemporaryFolder folder;
  session_.document().save(folder.file("scene.toml"));
  ASSERT_EQ(std::system(("'" PLENOFLAME_COMMAND "' render --quiet " + folder.file("scene.toml") +
                         " -o " + folder.file("command.exr"))
                            .c_str()),
            0);
  const LightField command = read_light_field(folder.file("command.exr"));
  const LightField& own = *session_.document().image();
  ASSERT_EQ(own.channels.size(), command.channels.size());
  EXPECT_EQ(own.channels[0].flux.pixels, command.channels[0].flux.pixels);
  EXPECT_EQ(own.channels[0].standard_error.pixels, command.channels[0].standard_error.pixels);
  EXPECT_EQ(own.samples, command.samples);
  EXPECT_TRUE(own.complete);
  double sum = 0;
  for (const float flux : own.channels[0].flux.pixels) sum += static_cast<double>(flux);
  EXPECT_GT(sum, 0);
}

TEST_F(SessionTest, PausedAndResumedImageHasTheSameBits) {
  open();
  session_.document().set_value("render.samples", "2048");
  ASSERT_TRUE(finish());
  const Image whole = session_.document().image()->channels[0].flux;
  session_.start_render();
  int pauses = 0;
  ASSERT_TRUE(wait_for([&] {
    RenderJob& job = session_.render();
    if (job.state() == RenderJob::State::running && job.status().pass == job.status().passes &&
        pauses < 3) {
      job.pause();
      ++pauses;
      EXPECT_EQ(job.state(), RenderJob::State::paused);
      job.resume();
    }
    return job.state() == RenderJob::State::finished;
  }));
  EXPECT_GE(pauses, 1);
  EXPECT_EQ(session_.document().image()->channels[0].flux.pixels, whole.pixels);
}

TEST_F(SessionTest, PictureThatIsBeingRefinedSaysWhatItShows) {
  open();
  session_.document().set_value("render.samples", kEndless);
  std::shared_ptr<const LightField> unfinished;
  QObject here;
  QObject::connect(&session_.document(), &Document::image_changed, &here, [&] {
    const auto& image = session_.document().image();
    if (image && !image->complete) unfinished = image;
  });
  ASSERT_TRUE(wait_for([&] { return unfinished != nullptr; }));
  session_.render().stop();
  // Written now, it can be opened again.
  const TemporaryFolder folder;
  write_light_field(folder.file("raw.exr"), *unfinished);
  Document other;
  other.open(folder.file("raw.exr"));
  EXPECT_TRUE(other.scene().camera == session_.document().scene().camera);
  ASSERT_TRUE(other.image());
  EXPECT_FALSE(other.image()->complete);
  EXPECT_EQ(other.image()->estimator, "backward");
  EXPECT_GT(other.image()->samples, 0);
  EXPECT_FALSE(other.image()->version.empty());
}

TEST_F(SessionTest, LightFieldThatIsOpenedFirstHasViews) {
  open();
  ASSERT_TRUE(finish());
  const TemporaryFolder folder;
  write_light_field(folder.file("raw.exr"), *session_.document().image());
  Session other;
  other.set_views_wanted(true);
  other.document().open(folder.file("raw.exr"));
  ASSERT_TRUE(wait_for([&] { return other.light_field().views() != nullptr; }));
  EXPECT_TRUE(other.document().image_is_current());
  EXPECT_EQ(other.render().state(), RenderJob::State::idle);  // it was there already
}

TEST_F(SessionTest, ViewsThatAreWantedLateAreOfAWholePass) {
  open();
  session_.document().set_value("render.samples", kEndless);
  std::shared_ptr<const LightField> whole;
  bool wanted = false;
  QObject here;
  QObject::connect(&session_.document(), &Document::image_changed, &here, [&] {
    const auto& image = session_.document().image();
    if (image && image->complete) whole = image;
    if (wanted || !whole || !image || image->complete) return;
    // A part of a pass is on display.
    wanted = true;
    EXPECT_EQ(session_.render().state(), RenderJob::State::running);
    session_.set_views_wanted(true);
    EXPECT_EQ(session_.light_field().field(), whole);
    // A run that was broken off is seen in them, too: nothing better comes by itself.
    session_.render().stop();
  });
  ASSERT_TRUE(wait_for([&] { return wanted; }));
  EXPECT_FALSE(session_.document().image()->complete);
  ASSERT_TRUE(wait_for([&] { return session_.light_field().views() != nullptr; }));
  EXPECT_EQ(session_.light_field().field(), session_.document().image());
}

TEST_F(SessionTest, ViewsOfAnOlderImageAreThoseOfItsCamera) {
  open();
  ASSERT_TRUE(finish());
  session_.set_auto_render(false);
  const CameraSpec taken_by = session_.compiler().compiled()->scene.camera;
  const auto before = session_.compiler().compiled();
  session_.document().set_value("camera.array.rotation", "3 deg");
  ASSERT_TRUE(wait_for([&] {
    return session_.compiler().is_current() && session_.compiler().compiled() != before;
  }));
  session_.set_views_wanted(true);
  ASSERT_TRUE(wait_for([&] { return session_.light_field().views() != nullptr; }));
  EXPECT_TRUE(session_.light_field().micro_images()->camera().spec() == taken_by);
  // The next image brings its own.
  session_.start_render();
  ASSERT_TRUE(finish());
  ASSERT_TRUE(wait_for([&] {
    return session_.light_field().field() == session_.document().image() &&
           session_.light_field().views();
  }));
  EXPECT_FALSE(session_.light_field().micro_images()->camera().spec() == taken_by);
}

TEST_F(SessionTest, ErrorFallsAlongTheCurve) {
  open();
  session_.document().set_value("render.samples", "1024");
  ASSERT_TRUE(finish());
  const auto& curve = session_.render().curve();
  ASSERT_GE(curve.size(), 4U);
  for (std::size_t i = 1; i < curve.size(); ++i) EXPECT_GE(curve[i].seconds, curve[i - 1].seconds);
  EXPECT_LT(curve.back().error, 0.2 * curve.front().error);
  EXPECT_GT(curve.back().error, 0);
}

TEST_F(SessionTest, ChangeRestartsOnlyWhatItTouches) {
  open();
  ASSERT_TRUE(finish());
  const auto compiled = session_.compiler().compiled();
  const auto image = session_.document().image();
  ASSERT_EQ(session_.compiler().flames().loads(), 1);
  session_.document().set_value("develop.bits", "8");
  session_.document().set_value("flames[0].name", "renamed");
  EXPECT_EQ(session_.render().state(), RenderJob::State::finished);
  EXPECT_EQ(session_.compiler().compiled(), compiled);
  EXPECT_EQ(session_.document().image(), image);
  // The camera moves: the flame stays loaded.
  session_.document().set_value("camera.focus.object_distance", "1.1 m");
  EXPECT_FALSE(session_.document().image_is_current());
  ASSERT_TRUE(wait_for([&] { return session_.document().image_is_current(); }));
  EXPECT_NE(session_.compiler().compiled(), compiled);
  EXPECT_EQ(session_.compiler().flames().loads(), 1);
  session_.document().set_value("flames[0].scale", "1.1");
  ASSERT_TRUE(wait_for([&] { return session_.document().image_is_current(); }));
  EXPECT_EQ(session_.compiler().flames().loads(), 2);
}

TEST_F(SessionTest, SceneWithAnErrorKeepsTheLastImageAndSaysWhy) {
  QString message;
  QObject::connect(&session_, &Session::failed,
                   [&](const QString&, const QString& text) { message = text; });
  open();
  ASSERT_TRUE(finish());
  const auto image = session_.document().image();
  session_.document().set_value("flames[0].position", "-1 m, 0 m, 0 m");
  EXPECT_FALSE(message.isEmpty());
  EXPECT_EQ(session_.document().image(), image);
  EXPECT_FALSE(session_.document().image_is_current());
  session_.document().undo();
  ASSERT_TRUE(wait_for([&] { return session_.document().image_is_current(); }));
}

TEST_F(SessionTest, FileThatCannotBeLoadedIsSaidAndNothingEnds) {
  QString message;
  QObject::connect(&session_, &Session::failed,
                   [&](const QString&, const QString& text) { message = text; });
  open();
  session_.document().set_value("flames[0].kind", "vdb");
  session_.document().set_value("flames[0].file", "/no/such/flame.vdb");
  ASSERT_TRUE(wait_for([&] { return message.contains("flame.vdb"); }));
  while (session_.document().can_undo()) session_.document().undo();
  ASSERT_TRUE(finish());
}

TEST_F(SessionTest, RaysOfAPixelSumToItsFlux) {
  open();
  ASSERT_TRUE(finish());
  session_.document().select(Selection::of_pixel(104, 92));
  ASSERT_TRUE(wait_for([&] { return session_.rays().rays() != nullptr; }));
  const SelectedRays& rays = *session_.rays().rays();
  double flux = 0;
  for (const RayRow& row : ray_rows(rays)) flux += row.weight * row.radiance;
  // The image has as many samples, drawn alike; it is kept in single precision and taken from a
  // table.
  const LightFieldChannel& channel = session_.document().image()->channels[0];
  const auto recorded = static_cast<double>(channel.flux.at(104, 92));
  ASSERT_GT(recorded, 0);
  EXPECT_TRUE(plenoflame::test::within_standard_errors(
      flux, recorded, 2 * static_cast<double>(channel.standard_error.at(104, 92)) + 1e-3 * recorded,
      5));
}

TEST_F(SessionTest, PixelsThatSeeAPointSeeItBack) {
  open();
  ASSERT_TRUE(finish());
  const Vec3 point{1.0, 0.002, 0.001};
  session_.document().select(Selection::of_point(point));
  ASSERT_TRUE(wait_for([&] { return session_.rays().rays() != nullptr; }));
  const auto seen = session_.rays().rays();
  ASSERT_FALSE(seen->pixels.empty());
  std::set<std::pair<int, int>> listed, arrived;
  for (const Pixel& p : seen->pixels) listed.emplace(p.column, p.row);
  for (const RayPath& ray : seen->paths.rays)
    if (ray.column >= 0) arrived.emplace(ray.column, ray.row);
  EXPECT_EQ(listed, arrived);
  // A ray of such a pixel passes the point within what a pixel covers out there.
  const Pixel pixel = seen->pixels[seen->pixels.size() / 2];
  session_.document().select(Selection::of_pixel(pixel.column, pixel.row));
  ASSERT_TRUE(wait_for([&] { return session_.rays().rays() && session_.rays().rays() != seen; }));
  const SelectedRays& back = *session_.rays().rays();
  double nearest = 1;
  for (const RayPath& ray : back.paths.rays) {
    if (ray.status.status != RayStatus::reached || ray.count < 2) continue;
    const Vec3 a = back.paths.vertices[ray.first + ray.count - 2].position,
               b = back.paths.vertices[ray.first + ray.count - 1].position;
    nearest = std::min(nearest, length(cross(point - a, normalize(b - a))));
  }
  EXPECT_LT(nearest, 4e-3);
}

TEST_F(SessionTest, RaysAreOfTheLastSelectionAndTheLastScene) {
  open();
  ASSERT_TRUE(finish());
  const Selection late = Selection::of_pixel(104, 92), newest = Selection::of_pixel(90, 80);
  std::vector<Selection> seen;
  QObject::connect(&session_.rays(), &RaySelector::rays_changed, &session_, [&] {
    if (session_.rays().rays()) seen.push_back(session_.rays().rays()->selection);
  });
  session_.document().select(late);
  // Done by now, but nobody has been told: this thread has not looked for events since.
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  session_.document().select(newest);
  EXPECT_FALSE(session_.rays().is_current());
  ASSERT_TRUE(wait_for([&] { return session_.rays().is_current(); }));
  ASSERT_FALSE(seen.empty());
  for (const Selection& selection : seen) EXPECT_EQ(selection, newest);
  // The camera changes: so do the rays of the same pixel.
  const auto before = session_.rays().rays();
  session_.document().set_value("camera.focus.object_distance", "1.2 m");
  ASSERT_TRUE(wait_for([&] { return session_.rays().rays() != before; }));
  EXPECT_EQ(session_.rays().rays()->scene, session_.compiler().compiled());
  session_.document().select({});
  EXPECT_TRUE(session_.rays().is_current());
  EXPECT_EQ(session_.rays().rays(), nullptr);
}

TEST_F(SessionTest, ViewsAndRefocusedPictureFollowTheImage) {
  session_.set_views_wanted(true);
  open();
  ASSERT_TRUE(finish());
  ASSERT_TRUE(wait_for([&] { return session_.light_field().views() != nullptr; }));
  EXPECT_EQ(session_.light_field().views()->views.size(),
            static_cast<std::size_t>(LightFieldJobs::kGrid * LightFieldJobs::kGrid));
  bool preview = false;
  QObject::connect(&session_.light_field(), &LightFieldJobs::refocused_changed,
                   [&] { preview |= session_.light_field().refocused().preview; });
  session_.light_field().refocus(1.0, 1);
  ASSERT_TRUE(wait_for([&] {
    return session_.light_field().refocused().image && !session_.light_field().refocused().preview;
  }));
  EXPECT_TRUE(preview);
  // The quick picture is like the exact one: both are radiances of the same flame.
  const Image quick =
      shift_and_add(*session_.light_field().views(), *session_.light_field().geometry(), 1.0);
  const Image& exact = *session_.light_field().refocused().image;
  double quick_sum = 0, exact_sum = 0;
  for (const float v : quick.pixels) quick_sum += static_cast<double>(v);
  for (const float v : exact.pixels) exact_sum += static_cast<double>(v);
  EXPECT_TRUE(relative(quick_sum / static_cast<double>(quick.pixels.size()),
                       exact_sum / static_cast<double>(exact.pixels.size()), 0.15));
}

TEST(ShiftAndAdd, GathersWhatLiesAtTheDepth) {
  // Views of a point that moves against the viewpoint by the disparity of its depth.
  ViewGeometry geometry;
  geometry.plane = 0;
  geometry.focus = 1;
  geometry.focal = 500;
  geometry.centre_step = 0.01;
  const double depth = 0.8;
  Views views;
  for (int j = -1; j <= 1; ++j)
    for (int i = -1; i <= 1; ++i) {
      View view;
      view.column = i + 1;
      view.row = j + 1;
      view.offset = {static_cast<double>(2 * i), static_cast<double>(2 * j)};
      view.image = Image(41, 41);
      // f * centre_step * offset * (1/z - 1/focus), written out: 500 * 0.01 * 0.25 per raw pixel.
      const double shift = 1.25;
      const double x = 20 - shift * view.offset.x, y = 20 - shift * view.offset.y;
      const int column = static_cast<int>(std::floor(x)), row = static_cast<int>(std::floor(y));
      const double a = x - column, b = y - row;
      view.image.at(column, row) = static_cast<float>((1 - a) * (1 - b));
      view.image.at(column + 1, row) = static_cast<float>(a * (1 - b));
      view.image.at(column, row + 1) = static_cast<float>((1 - a) * b);
      view.image.at(column + 1, row + 1) = static_cast<float>(a * b);
      views.views.push_back(view);
    }
  const Image sharp = shift_and_add(views, geometry, depth);
  const Image blurred = shift_and_add(views, geometry, 1.3);
  const auto at = [](const Image& image) { return static_cast<double>(image.at(20, 20)); };
  // Interpolated twice: the middle keeps (1 - 2 a (1 - a))^2 of what a view has there, a = 1/2 or
  // 0.
  EXPECT_GT(at(sharp), 0.4);
  EXPECT_LT(at(blurred), 0.3 * at(sharp));
}

TEST(MicrolensOfPixel, IsTheOneWithTheNearestCentreOfItsMicroImage) {
  for (const char* preset : {"paper-previous-60x60", "paper-plenoptic2", "raytrix-r29"}) {
    const Camera camera(
        parse_scene(std::string("[camera]\npreset = \"") + preset + "\"\n", "").scene.camera);
    const MicroImages micro(camera, false);
    const double pitch = camera.spec().array.pitch, scale = pitch / micro.spacing();
    const int columns = camera.spec().sensor.columns, rows = camera.spec().sensor.rows;
    std::mt19937 random(5);
    std::uniform_int_distribution<int> any_column(0, columns - 1), any_row(0, rows - 1);
    int compared = 0, oblique = 0;
    for (int i = 0; i < 300; ++i) {
      const int column = any_column(random), row = any_row(random);
      const Vec2 point = camera.sensor_point(column + 0.5, row + 0.5);
      std::vector<std::pair<double, LensIndex>> near;
      for (const LensIndex lens :
           camera.lattice().within(scale * point - Vec2{3 * pitch, 3 * pitch},
                                   scale * point + Vec2{3 * pitch, 3 * pitch})) {
        const MicroImages::Place place = micro.place(lens);
        if (!place.dark) near.emplace_back(length(place.centre - point), lens);
      }
      std::sort(near.begin(), near.end(),
                [](const auto& a, const auto& b) { return a.first < b.first; });
      // Between two of them it may be either.
      if (near.size() < 2 || near[1].first - near[0].first < 0.02 * pitch) continue;
      EXPECT_EQ(microlens_of_pixel(camera, column, row), near[0].second)
          << preset << " " << column << ", " << row;
      ++compared;
      oblique += near[0].second == camera.lattice().nearest(point) ? 0 : 1;
    }
    EXPECT_GT(compared, 200) << preset;
    EXPECT_GT(oblique, 10) << preset;
  }
}

TEST(FlamePoint, IsWhereAnOpaqueFlameBegins) {
  std::vector<SourceFunction> channels{SourceFunction::total()};
  const RigidTransform here{Mat3{}, {2, 0, 0}};
  const auto medium =
      make_layered_medium({{{0, 0, 0}, {0.1, 0.1, 0.1}, 1500, 1000}}, here, channels);
  Vec3 point;
  ASSERT_TRUE(flame_point(*medium, {{0, 0, 0}, {1, 0, 0}}, point));
  EXPECT_TRUE(relative(point.x, 1.9, 1e-3));
  EXPECT_FALSE(flame_point(*medium, {{0, 0, 0}, {0, 1, 0}}, point));
  EXPECT_FALSE(flame_point(*medium, {{0, 0, 0}, {-1, 0, 0}}, point));
}

TEST(PassSamples, GrowToWhatWasAskedFor) {
  EXPECT_EQ(pass_samples(64, 2), (std::vector<int>{8, 64}));
  EXPECT_EQ(pass_samples(1024, 2), (std::vector<int>{2, 16, 128, 1024}));
  EXPECT_EQ(pass_samples(2, 2), (std::vector<int>{2}));
  EXPECT_EQ(pass_samples(1, 1), (std::vector<int>{1}));
}

TEST(LatestTask, OnlyTheLatestRequestRuns) {
  LatestTask task(Urgency::work);
  std::atomic<bool> go{false};
  std::atomic<int> ran{0}, stopped{0};
  task.request([&](const std::stop_token& stop) {
    while (!go && !stop.stop_requested()) std::this_thread::yield();
    stopped += stop.stop_requested() ? 1 : 0;
  });
  while (!task.busy()) std::this_thread::yield();
  for (int i = 1; i <= 100; ++i)
    task.request([&ran, i](const std::stop_token&) { ran = ran * 1000 + i; });
  go = true;
  while (task.busy()) std::this_thread::yield();
  EXPECT_EQ(ran % 1000, 100);
  EXPECT_LE(stopped, 1);
}

TEST(LatestTask, ExceptionIsReportedAndTheThreadGoesOn) {
  std::string message;
  std::atomic<bool> told{false}, ran{false};
  LatestTask task(Urgency::work, [&](const std::string& text) {
    message = text;
    told = true;
  });
  task.request([](const std::stop_token&) { throw std::runtime_error("went wrong"); });
  while (!told) std::this_thread::yield();
  EXPECT_EQ(message, "went wrong");
  task.request([&](const std::stop_token&) { ran = true; });
  while (!ran) std::this_thread::yield();
}

}  // namespace
}  // namespace plenoflame::desktop::test
