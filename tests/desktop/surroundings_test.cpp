// Solid surfaces, windows and further cameras in the 3-D view. References: where their points lie
// in the world, their colours, the side from which the command's picture shows the same scene.
#include <QVTKOpenGLNativeWidget.h>

#include <QAction>
#include <QColor>
#include <QComboBox>
#include <QLabel>
#include <QSlider>
#include <QToolButton>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "gui_tests.h"
#include "scene_fixture.h"
#include "scenes.h"
#include "widgets/image/light_field_panel.h"

using namespace plenoflame;
using namespace plenoflame::desktop;

class SurroundingsTest : public test::SceneFixture {
  Q_OBJECT

  bool open_text(const std::string& text) {
    write(file("scene.toml"), text.c_str());
    return window_->open(file("scene.toml")) && settled();
  }
  void toggle(const char* action) {
    for (auto* button : window_->findChildren<QToolButton*>())
      if (button->defaultAction() == child<QAction>(action))
        return QTest::mouseClick(button, Qt::LeftButton);
    QFAIL(action);
  }
  static double apart(QPointF a, QPointF b) { return std::hypot(a.x() - b.x(), a.y() - b.y()); }
  /// True if something is drawn near a point of the world whose colour `is` accepts.
  template <class Is>
  bool drawn_at(Vec3 point, Is is) {
    const QImage drawn = view().picture();
    const double ratio = drawn.devicePixelRatio();
    const QPoint at = (ratio * view().to_widget(point)).toPoint();
    constexpr int kReach = 2;
    for (int y = at.y() - kReach; y <= at.y() + kReach; ++y)
      for (int x = at.x() - kReach; x <= at.x() + kReach; ++x)
        if (drawn.rect().contains(x, y) && is(QColor(drawn.pixel(x, y)))) return true;
    return false;
  }
  static bool yellow(const QColor& c) { return c.red() > 180 && c.red() > c.blue() + 60; }
  static bool bluish(const QColor& c) { return c.blue() > c.red() + 40; }
  Vec3 flame_middle() {
    const Box box = scene().medium->bounds();
    return 0.5 * (box.lower + box.upper);
  }

 private slots:
  void init() { begin(); }
  void cleanup() { end(); }

  void solidSurfacesAreDrawnAndFollowEdits() {
    QVERIFY(open_text(test::small_scene_text() +
                      "\n[[surfaces]]\nname = \"lamp\"\nshape = \"sphere\"\n"
                      "position = [\"1 m\", \"120 mm\", \"0 m\"]\nradius = \"20 mm\"\n"
                      "[surfaces.material]\nkind = \"emitter\"\nradiance = \"1 W/(m^2 sr)\"\n"));
    const Vec3 lamp{1, 0.12, 0};
    for (const Qt::Key key : {Qt::Key_1, Qt::Key_2}) {
      QVERIFY(part(key));
      QVERIFY(child<QWidget>("scene3d")->rect().contains(seen_at(lamp)));
      QVERIFY(drawn_at(lamp, yellow));
    }
    QVERIFY(part(Qt::Key_3));  // the camera alone
    QVERIFY(!drawn_at(lamp, yellow));
    // It goes where it is put.
    QVERIFY(part(Qt::Key_1));
    type("surfaces[0].position", "1 m, 0 m, 120 mm");
    QVERIFY(settled());
    QVERIFY(drawn_at({1, 0, 0.12}, yellow));
    QVERIFY(!drawn_at(lamp, yellow));
    session().document().erase_item("surfaces", 0);
    QVERIFY(settled());
    QVERIFY(!drawn_at({1, 0, 0.12}, yellow));
  }

  void windowsAreDrawnAndFollowEdits() {
    QVERIFY(open_text(test::small_scene_text() +
                      "\n[[windows]]\nshape = \"plate\"\nposition = [\"0.5 m\", \"0 m\", \"0 m\"]\n"
                      "rotation = [\"0 deg\", \"90 deg\", \"0 deg\"]\ndiameter = \"300 mm\"\n"
                      "thickness = \"20 mm\"\nindex = 1.5\n"));
    QVERIFY(part(Qt::Key_1));
    // Its first face stands at its place, the glass behind it: turned by 90 degrees, along x.
    for (const Vec3& rim : {Vec3{0.5, 0, 0.15}, Vec3{0.52, 0, -0.15}})
      QVERIFY(drawn_at(rim, bluish));
    // The picture is of the scene with the glass where it is now.
    const auto before = session().document().image();
    type("windows[0].position", "0.7 m, 0 m, 0 m");
    QVERIFY(settled());
    QVERIFY(drawn_at({0.7, 0, 0.15}, bluish));
    QVERIFY(!drawn_at({0.5, 0, 0.15}, bluish));
    QVERIFY(session().document().image() != before);
    QVERIFY(session().document().image_is_current());
  }

  void severalCamerasComeNearer() {
    QVERIFY(window_->open(PLENOFLAME_EXAMPLES "/three-cameras.toml") && settled());
    QVERIFY(part(Qt::Key_1));
    const auto seen = [this] {
      std::vector<QPointF> places = view().other_cameras_seen();
      places.push_back(view().to_widget(world({0, 0, 0})));
      return places;
    };
    QCOMPARE(seen().size(), std::size_t{3});
    const auto height = [this] {
      const Box box = scene().medium->bounds();
      const Vec3 middle = flame_middle();
      return apart(view().to_widget({middle.x, middle.y, box.lower.z}),
                   view().to_widget({middle.x, middle.y, box.upper.z}));
    };
    const auto farthest = [&] {  // camera from the flame, in heights of the flame
      double far = 0;
      for (const QPointF& place : seen())
        far = std::max(far, apart(place, view().to_widget(flame_middle())));
      return far / height();
    };
    const double near = farthest();
    const double small = height();
    toggle("shortenGaps");
    QVERIFY2(farthest() > 3 * near, qPrintable(QString("%1 %2").arg(near).arg(farthest())));
    QVERIFY(height() < 0.5 * small);
    toggle("shortenGaps");
    // All are in the view, and apart from each other.
    const auto places = seen();
    for (std::size_t i = 0; i < places.size(); ++i) {
      QVERIFY(scene3d()->rect().contains(places[i].toPoint()));
      for (std::size_t k = 0; k < i; ++k) QVERIFY(apart(places[i], places[k]) > 0.2 * small);
    }
    // A click finds the thing at its place in the world.
    QTest::mouseClick(scene3d(), Qt::LeftButton, {}, seen_at(flame_middle()));
    QVERIFY(selection().kind == Selection::Kind::point);
    QVERIFY(length(selection().point - flame_middle()) < 0.03);
  }

  void anotherCameraIsChosen() {
    QVERIFY(window_->open(PLENOFLAME_EXAMPLES "/three-cameras.toml") && settled());
    auto* const chooser = child<QComboBox>("cameraChoice");
    QVERIFY(chooser->isVisible());
    QCOMPARE(chooser->count(), 3);
    QCOMPARE(scene().scene.camera.name, std::string("front"));
    const Image front = session().document().image()->channels[0].flux;
    chooser->setFocus();
    QTest::keyClick(chooser, Qt::Key_Down);
    QVERIFY(settled());
    QCOMPARE(scene().scene.camera.name, std::string("side"));
    // Views and picture are of that one: its own axis looks along y.
    QVERIFY(length(world({0, 0, 1}) - Vec3{1, 0, 0}) < 1e-12);
    run(PLENOFLAME_COMMAND, {"render", PLENOFLAME_EXAMPLES "/three-cameras.toml", "--camera",
                             "side", "-o", file("side.exr")});
    const Image side = read_light_field(file("side.exr").toStdString()).channels[0].flux;
    QVERIFY(session().document().image()->channels[0].flux.pixels == side.pixels);
    QVERIFY(side.pixels != front.pixels);
    // It is no change of the scene.
    QVERIFY(!session().document().is_modified());
    QVERIFY(!session().document().can_undo());
  }

  void theCommandsPictureIsOfTheSameSide() {
    QVERIFY(open_example("lenslets-30"));
    QVERIFY(part(Qt::Key_1));
    const bool left = view().to_widget(flame_middle()).x() < view().to_widget(world({})).x();
    QVERIFY(left);  // light runs from left to right, as in the section
    run(PLENOFLAME_COMMAND, {"picture", PLENOFLAME_EXAMPLES "/lenslets-30.toml", "--no-insets",
                             "--no-axes", "-o", file("picture.png")});
    const QImage picture(file("picture.png"));
    QVERIFY(!picture.isNull());
    // The flame is purple, the lens bluish grey; the bar of colours stands at the bottom.
    double flame = 0, glass = 0;
    int of_flame = 0, of_glass = 0;
    for (int y = 0; y < picture.height() * 8 / 10; ++y)
      for (int x = 0; x < picture.width(); ++x) {
        const QColor c(picture.pixel(x, y));
        const bool purple = c.red() > c.green() + 40 && c.blue() > c.green() + 10;
        const bool grey_blue = c.blue() > c.red() + 15 && c.blue() < c.red() + 80 &&
                               c.green() > c.red() && c.blue() > c.green();
        if (purple) flame += x, ++of_flame;
        if (grey_blue) glass += x, ++of_glass;
      }
    QVERIFY(of_flame > 50 && of_glass > 50);
    QVERIFY2(flame / of_flame < glass / of_glass,
             qPrintable(QString("%1 %2").arg(flame / of_flame).arg(glass / of_glass)));
  }

  void flamesHaveTheSameColoursInTheWindowAndInTheCommandsPicture() {
    QVERIFY(open_example("lenslets-30"));
    draw_temperatures();
    QVERIFY(part(Qt::Key_2));
    run(PLENOFLAME_COMMAND, {"picture", PLENOFLAME_EXAMPLES "/lenslets-30.toml", "--no-insets",
                             "-o", file("picture.png")});
    // Inferno, as it was published, from 0.4 to 1 of its length.
    const std::array<QColor, 5> published{QColor(148, 38, 102), QColor(206, 67, 71),
                                          QColor(243, 120, 25), QColor(250, 191, 39),
                                          QColor(252, 255, 164)};
    const QImage window = view().picture(), picture(file("picture.png"));
    // Bars are drawn in 256 steps and end one before the map's end. The steepest channel, blue near
    // the end, goes from 105 to 164 in 0.0625 of the whole map: 2.2 in a step of 0.6 / 256 of it,
    // and one more by rounding.
    constexpr int kSteps = 4;
    const auto has = [](const QImage& image, const QRect& bar, const QColor& wanted) {
      for (int y = bar.top(); y <= bar.bottom(); ++y)
        for (int x = bar.left(); x <= bar.right(); ++x) {
          const QColor c(image.pixel(x, y));
          if (std::abs(c.red() - wanted.red()) <= kSteps &&
              std::abs(c.green() - wanted.green()) <= kSteps &&
              std::abs(c.blue() - wanted.blue()) <= kSteps)
            return true;
        }
      return false;
    };
    // The bars of temperatures: at the window's right edge, at the bottom of the picture.
    const QRect upright(window.width() * 85 / 100, 0, window.width() * 15 / 100 - 1,
                        window.height() - 1);
    const QRect lying(picture.width() / 2, picture.height() * 8 / 10, picture.width() / 2 - 1,
                      picture.height() * 2 / 10 - 1);
    for (const QColor& colour : published) {
      QVERIFY2(has(window, upright, colour), qPrintable(colour.name()));
      QVERIFY2(has(picture, lying, colour), qPrintable(colour.name()));
    }
  }

  void viewsThroughGlassAreThoseOfTheCommand() {
    const std::string plate =
        "\n[[windows]]\nshape = \"plate\"\nposition = [\"0.5 m\", \"0 m\", \"0 m\"]\n"
        "rotation = [\"0 deg\", \"90 deg\", \"0 deg\"]\ndiameter = \"300 mm\"\n"
        "thickness = \"100 mm\"\nindex = 1.5\n";
    write(file("glass.toml"), (test::small_scene_text() + plate).c_str());
    run(PLENOFLAME_COMMAND, {"render", file("glass.toml"), "-o", file("raw.exr")});
    QVERIFY(window_->open(file("raw.exr")));
    QVERIFY(written() && settled());
    show_tab(LightFieldPanel::Tab::views);
    QVERIFY(until([this] { return session().light_field().views() != nullptr; }));
    const auto views = session().light_field().views();
    run(PLENOFLAME_COMMAND, {"views", file("raw.exr"), "--grid",
                             QString::number(LightFieldJobs::kGrid), "--exr", "-o", file("views")});
    int equal = 0;
    for (const View& one : views->views) {
      const QString name = QString("views/view_%1_%2.exr")
                               .arg(one.row, 2, 10, QChar('0'))
                               .arg(one.column, 2, 10, QChar('0'));
      QVERIFY2(QFile::exists(file(name)), qPrintable(name));
      equal +=
          read_light_field(file(name).toStdString()).channels[0].flux.pixels == one.image.pixels
              ? 1
              : 0;
    }
    QCOMPARE(equal, static_cast<int>(views->views.size()));
  }

  void numbersStandBesideTheColourBar() {
    QVERIFY(open_example("lenslets-30"));
    draw_temperatures();
    // As it is on the screen: a picture for a file is laid out anew.
    auto* const screen = dynamic_cast<QVTKOpenGLNativeWidget*>(scene3d());
    const auto ink = [screen] {
      const QImage all = screen->grabFramebuffer();
      const int top = all.height() / 6;  // below the cube
      const QImage shown = all.copy(4 * all.width() / 5, top, all.width() / 5, all.height() - top);
      int bar = shown.width();
      std::array<int, 2> counts{};  // of pixels left of the bar, and over it or right of it
      for (int x = 0; x < shown.width(); ++x)
        for (int y = 0; y < shown.height(); ++y) {
          const QColor c(shown.pixel(x, y));
          const auto [low, high] = std::minmax({c.red(), c.green(), c.blue()});
          if (high - low > 100) bar = std::min(bar, x);
          if (high - low < 16 && low > 150) ++counts[x < bar ? 0 : 1];
        }
      return counts;
    };
    for (const Qt::Key key : {Qt::Key_1, Qt::Key_2, Qt::Key_1, Qt::Key_3, Qt::Key_1}) {
      QVERIFY(part(key));
      QTest::qWait(50);
      if (key == Qt::Key_3) continue;  // has no bar
      const auto [beside, over] = ink();
      QVERIFY2(beside > 50 && over == 0, qPrintable(QString("%1, %2").arg(beside).arg(over)));
    }
  }
};

std::unique_ptr<QObject> plenoflame::desktop::test::make_surroundings_test() {
  return std::make_unique<SurroundingsTest>();
}

#include "surroundings_test.moc"
