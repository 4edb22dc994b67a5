// Time, films, the guided tour: what a lecture shows. References: the table that moves a flame,
// values between two ends by arithmetic, what the steps of the tour say.
#include <QVTKOpenGLNativeWidget.h>
#include <vtkActor.h>
#include <vtkImageData.h>
#include <vtkPropCollection.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkRendererCollection.h>
#include <vtkTexture.h>

#include <QAction>
#include <QComboBox>
#include <QLabel>
#include <QLineEdit>
#include <QScreen>
#include <QSlider>
#include <QSpinBox>
#include <QTabWidget>
#include <QToolButton>
#include <array>
#include <cmath>
#include <set>

#include "gui_tests.h"
#include "plenoflame/base/units.h"
#include "plenoflame/volumes/grid_writer.h"
#include "scene_fixture.h"
#include "scenes.h"
#include "widgets/controls/time_bar.h"
#include "widgets/image/colour_bar.h"
#include "widgets/image/light_field_panel.h"
#include "widgets/window/compare_window.h"
#include "widgets/window/film_dialog.h"
#include "widgets/window/tour_dialog.h"

using namespace plenoflame;
using namespace plenoflame::desktop;

namespace {

/// The flame goes 10 mm sideways in 30 ms; pictures each 10 ms.
constexpr const char* kMovingKeys = R"(
[camera]
preset = "paper-previous-60x60"
[camera.sensor]
columns = 200
rows = 180
pixel_pitch = "100 um"
frame_rate = "100 Hz"
[[flames]]
preset = "paper-layered"
position = ["1 m", "0 m", "-29 mm"]
time_table = "way.csv"
[render]
samples = 8
)";

}  // namespace

class LectureTest : public test::SceneFixture {
  Q_OBJECT

  /// Below each picture stands a line, and no two are the same.
  void picturesSayTheirValues(const char* name, int count) {
    std::vector<QImage> lines;
    for (int i = 1; i <= count; ++i) {
      const QImage picture(file(QString(name).arg(i, 4, 10, QChar('0'))));
      QVERIFY2(!picture.isNull(), qPrintable(QString(name).arg(i)));
      lines.push_back(picture.copy(0, picture.height() * 95 / 100, picture.width(),
                                   picture.height() * 5 / 100));
      int bright = 0;
      for (int y = 0; y < lines.back().height(); ++y)
        for (int x = 0; x < lines.back().width(); ++x)
          bright += lines.back().pixelColor(x, y).lightness() > 150 ? 1 : 0;
      QVERIFY2(bright > 60, qPrintable(QString::number(bright)));
      for (std::size_t k = 0; k + 1 < lines.size(); ++k) QVERIFY(lines[k] != lines.back());
    }
  }

 private slots:
  void init() { begin(); }
  void cleanup() { end(); }

  void timeMovesTheFlame() {
    write(file("way.csv"), "time [ms], y [mm]\n0, -5\n30, 5\n");
    write(file("way.toml"), kMovingKeys);
    QVERIFY(window_->open(file("way.toml")));
    QVERIFY(settled());
    auto* const slider = child<QSlider>("timeSlider");
    QVERIFY(slider->isVisible());
    QCOMPARE(slider->minimum(), 0);
    QVERIFY(slider->maximum() >= 2);
    const auto middle = [this] {
      const Box box = scene().medium->bounds();
      return 0.5 * (box.lower.y + box.upper.y);
    };
    QVERIFY(std::abs(middle() + 5e-3) < 1e-9);
    slider->setFocus();
    QTest::keyClick(slider, Qt::Key_Right);
    QTest::keyClick(slider, Qt::Key_Right);
    QVERIFY(settled());
    // By the table: -5 mm + 10 mm * 20 / 30.
    QVERIFY2(std::abs(middle() - (-5e-3 + 1e-2 * 20 / 30)) < 1e-9,
             qPrintable(QString::number(middle())));
    QVERIFY(child<QLabel>("timeLabel")->text().startsWith("20 ms"));
    // The scene has not changed, and its file is as it was.
    QVERIFY(!session().document().is_modified());
    // Playing goes through all moments and begins again.
    std::set<int> seen;
    QObject here;
    connect(slider, &QSlider::valueChanged, &here, [&](int value) { seen.insert(value); });
    QTest::mouseClick(child<QToolButton>("timePlay"), Qt::LeftButton);
    QVERIFY(until([&] { return static_cast<int>(seen.size()) == slider->maximum() + 1; }));
    QTest::mouseClick(child<QToolButton>("timePlay"), Qt::LeftButton);
    QVERIFY(!child<TimeBar>("timeBar")->is_playing());
    QVERIFY(settled());
    // A scene that stays has no such bar.
    QVERIFY(window_->open_example("lenslets-30"));
    QVERIFY(!slider->isVisible());
  }

  void nextMomentIsThereBeforeItIsAskedFor() {
    // Two flames of cubes, told apart by their voxels.
    const auto write_flame = [this](int number, double voxel) {
      VoxelField hot;
      hot.brick_origins = {{0, 0, 0}};
      hot.index_to_world.linear.rows = {{{voxel, 0, 0}, {0, voxel, 0}, {0, 0, voxel}}};
      VoxelField sooty = hot;
      hot.name = "temperature";
      hot.values.assign(512, 1600);
      sooty.name = "absorption";
      sooty.values.assign(512, 12);
      const std::array<GridOutput, 2> grids{{{&hot, "K"}, {&sooty, "1/m"}}};
      write_grids(file(QString("burns_%1.vdb").arg(number)).toStdString(), grids);
    };
    write_flame(1, 3e-3);
    write_flame(2, 5e-3);
    write(file("series.toml"),
          "[camera]\npreset = \"paper-previous-60x60\"\n[camera.sensor]\ncolumns = 200\n"
          "rows = 180\npixel_pitch = \"100 um\"\n[[flames]]\nkind = \"vdb\"\n"
          "file = \"burns_#.vdb\"\nframe_rate = \"100 Hz\"\n"
          "position = [\"1 m\", \"0 m\", \"0 m\"]\n[render]\nsamples = 8\n");
    QVERIFY(window_->open(file("series.toml")));
    QVERIFY(settled());
    const auto width = [this] {
      const Box box = scene().medium->bounds();
      return box.upper.y - box.lower.y;
    };
    const double first = width();
    QVERIFY(until([this] { return session().compiler().is_prepared(); }));
    QTest::qWait(50);  // its end comes through the event loop
    // Nobody can read the second one any more: it is in memory.
    QVERIFY(QFile::remove(file("burns_2.vdb")));
    auto* const slider = child<QSlider>("timeSlider");
    QVERIFY(slider->isVisible());
    slider->setFocus();
    QTest::keyClick(slider, Qt::Key_Right);
    QVERIFY(settled());
    QVERIFY2(session().compiler().failure().isEmpty(), qPrintable(session().compiler().failure()));
    QVERIFY2(std::abs(width() / first - 5.0 / 3) < 0.1,
             qPrintable(QString::number(width() / first)));
  }

  void filmOfAParameter() {
    QCOMPARE(between("camera.focus.object_distance", "1 m", "2 m", 0.25), std::string("1.25 m"));
    QCOMPARE(between("flames[0].position", "1 m, 0 m, 0 m", "1 m, 20 mm, 0 m", 0.5),
             std::string("1 m, 10 mm, 0 m"));
    QVERIFY_EXCEPTION_THROWN(between("camera.focus.mode", "best", "best", 0.5), InputError);
    write(file("small.toml"), test::small_scene_text().c_str());
    QVERIFY(window_->open(file("small.toml")));
    QVERIFY(settled());
    window_->scene_panel().reveal("flames[0].brightness");
    QVERIFY(click_menu({"Render", "Film of a parameter..."}));
    auto* const film = child<FilmDialog>("filmDialog");
    auto* const from = child<QLineEdit>("filmFrom");
    auto* const to = child<QLineEdit>("filmTo");
    // A span around the value, so that something moves.
    QCOMPARE(from->text(), QString("0.9"));
    QCOMPARE(to->text(), QString("1.1"));
    from->setFocus();
    from->selectAll();
    QTest::keyClicks(from, "1");
    to->setFocus();
    to->selectAll();
    QTest::keyClicks(to, "1");
    film->record(file("film.png"));
    QVERIFY2(!film->is_recording() && film->message().contains("same value"),
             qPrintable(film->message()));

    to->selectAll();
    QTest::keyClicks(to, "-1");
    film->record(file("film.png"));  // as it is refused in the tree
    QVERIFY(!film->is_recording() && film->message().contains("brightness"));
    to->selectAll();
    QTest::keyClicks(to, "0.25");
    auto* const frames = child<QSpinBox>("filmFrames");
    frames->setFocus();
    frames->selectAll();
    QTest::keyClicks(frames, "3");
    answer_file_dialog(file("film.png"));
    QTest::mouseClick(child<QPushButton>("filmRecord"), Qt::LeftButton);
    QVERIFY(film->is_recording());
    QVERIFY2(!film->message().contains("brightness"), qPrintable(film->message()));
    QVERIFY(until([&] { return !film->is_recording(); }));
    QVERIFY2(film->message().startsWith("3 pictures"), qPrintable(film->message()));
    for (const char* name : {"film.0001.png", "film.0002.png", "film.0003.png"})
      QVERIFY(!QImage(file(name)).isNull());
    QVERIFY(!QFile::exists(file("film.0004.png")));
    picturesSayTheirValues("film.%1.png", 3);
    // All have one scale of brightness. A quarter of the light is 0.25^(1/2.2), 0.53 of the white
    // of a display, and colours of less light are darker.
    const auto light = [this](const char* name) {
      const QImage picture(file(name));
      double sum = 0;
      for (int y = 0; y < picture.height(); ++y)
        for (int x = 0; x < picture.width(); ++x) {
          const QColor c(picture.pixel(x, y));
          if (c.red() > 1.2 * c.blue() + 10) sum += c.red();  // not the ground beside it
        }
      return sum;
    };
    QVERIFY2(light("film.0003.png") < 0.7 * light("film.0001.png"),
             qPrintable(QString("%1 %2").arg(light("film.0001.png")).arg(light("film.0003.png"))));
    QCOMPARE(session().document().scene().flames[0].brightness, 1.0);
    QVERIFY(!session().document().is_modified());
    film->close();
  }

  void filmBeginsWithTheFocusAndMovesTheFNumber() {
    write(file("small.toml"), test::small_scene_text().c_str());
    QVERIFY(window_->open(file("small.toml")));
    QVERIFY(settled());
    QVERIFY(click_menu({"Render", "Film of a parameter..."}));
    auto* const film = child<FilmDialog>("filmDialog");
    auto* const parameter = child<QComboBox>("filmParameter");
    auto* const from = child<QLineEdit>("filmFrom");
    auto* const to = child<QLineEdit>("filmTo");
    const double focus = session().document().scene().camera.focus.object_distance;
    const auto metres = [](const QLineEdit* line) {
      return parse_quantity(line->text().toStdString(), Dimension::length);
    };
    QCOMPARE(parameter->currentText(), QString("camera.focus.object_distance"));
    QVERIFY2(std::fabs(metres(from) / focus - 0.9) < 0.01, qPrintable(from->text()));
    QVERIFY2(std::fabs(metres(to) / focus - 1.1) < 0.01, qPrintable(to->text()));
    // A place of 0 has no tenth of itself.
    parameter->setCurrentText("camera.array.rotation");
    QCOMPARE(from->text(), QString("0 rad"));
    QVERIFY2(to->text() != from->text(), qPrintable(to->text()));
    // The film has the picture alone: its ground has no place in it.
    parameter->setCurrentText("camera.lens.f_number");
    QCOMPARE(parameter->currentText(), QString("camera.lens.f_number"));
    const QString before = from->text();
    to->setFocus();
    to->selectAll();
    QTest::keyClicks(to, "16");
    child<QSpinBox>("filmFrames")->setValue(2);
    answer_file_dialog(file("stops.png"));
    QTest::mouseClick(child<QPushButton>("filmRecord"), Qt::LeftButton);
    QVERIFY(film->is_recording());
    QVERIFY(until([&] { return !film->is_recording(); }));
    QVERIFY2(film->message().startsWith("2 pictures"), qPrintable(film->message()));
    picturesSayTheirValues("stops.%1.png", 2);
    const QImage picture(file("stops.0001.png"));
    const double aspect = 200.0 / 180;
    const int line = picture.height() - static_cast<int>(std::lround(picture.width() / aspect));
    QVERIFY2(line > 10 && line < 0.12 * picture.height(), qPrintable(QString::number(line)));
    const QColor ground = image().palette().color(QPalette::Dark);
    for (int y = 0; y < picture.height(); ++y)
      for (const int x : {0, picture.width() - 1}) QVERIFY(picture.pixelColor(x, y) != ground);
    film->close();
  }

  void tourOfTenSteps() {
    QVERIFY(click_menu({"Help", "Guided tour"}));
    auto* const tour = child<TourDialog>("tourDialog");
    QVERIFY(tour && tour->steps() == 10);
    QVERIFY(settled());
    auto* const next = child<QPushButton>("tourNext");
    const auto at = [&](int step) { return tour->step() == step && settled(); };
    const QString folder = qEnvironmentVariable("PLENOFLAME_TOUR");
    const std::array<SceneView::Part, 10> parts{SceneView::Part::scene,  SceneView::Part::flame,
                                                SceneView::Part::camera, SceneView::Part::array,
                                                SceneView::Part::array,  SceneView::Part::array,
                                                SceneView::Part::scene,  SceneView::Part::camera,
                                                SceneView::Part::scene,  SceneView::Part::scene};
    for (int step = 0; step < 10; ++step) {
      QVERIFY(at(step));
      QVERIFY2(view().part() == parts[static_cast<std::size_t>(step)],
               qPrintable(QString::number(step)));
      QVERIFY(child<QLabel>("tourText")->text().contains(QString("%1 of 10").arg(step + 1)));
      QCOMPARE(selection().kind == Selection::Kind::pixel, step == 6);
      QCOMPARE(selection().kind == Selection::Kind::point, step == 7);
      // The tour stands beside what it explains.
      const auto on_screen = [](const QWidget* widget) {
        return QRect(widget->mapToGlobal(QPoint(0, 0)), widget->size());
      };
      for (const char* name : {"raysTable", "sceneTree", "scene3d", "rawImage"}) {
        const auto* const shown = child<QWidget>(name);
        if (!shown->isVisible() || shown->visibleRegion().isEmpty()) continue;
        const QRect seen =
            shown->visibleRegion().boundingRect().translated(shown->mapToGlobal(QPoint(0, 0)));
        QVERIFY2(!seen.intersects(on_screen(tour)), name);
      }
      if (step == 6) QVERIFY(!child<QWidget>("raysTable")->visibleRegion().isEmpty());
      if (step == 6)
        QVERIFY(session().rays().rays() && !session().rays().rays()->paths.rays.empty());
      if (!folder.isEmpty())
        window_->save_screenshot(QString("%1/step%2.png").arg(folder).arg(step + 1));
      if (step < 9) QTest::mouseClick(next, Qt::LeftButton);
    }
    QVERIFY(window_->light_field_panel().tab() == LightFieldPanel::Tab::refocus);
    QTest::mouseClick(next, Qt::LeftButton);
    QVERIFY(until([this] { return !child<TourDialog>("tourDialog"); }));
  }

  void twoScenesSideBySide() {
    write(file("small.toml"), test::small_scene_text().c_str());
    // The same flame, twice as bright: the same rays, so twice the flux everywhere.
    std::string twice = test::small_scene_text();
    const std::string key = "preset = \"paper-layered\"\n";
    twice.insert(twice.find(key) + key.size(), "brightness = 2\n");
    write(file("twice.toml"), twice.c_str());
    QVERIFY(window_->open(file("small.toml")));
    QVERIFY(settled());
    answer_file_dialog(file("twice.toml"));
    QVERIFY(click_menu({"View", "Compare with a scene..."}));
    auto* const window = child<CompareWindow>("compareWindow");
    QVERIFY(window);
    Session& other = window->other();
    QVERIFY(until([&] {
      return other.document().image() && other.render().state() == RenderJob::State::finished;
    }));
    auto* const left = child<ImageView>("compareLeft");
    auto* const right = child<ImageView>("compareRight");
    QVERIFY(until([&] {
      return left->image() && right->image() &&
             std::abs(right->image()->largest() / left->image()->largest() / 2.0F - 1) < 1e-5F;
    }));
    QCOMPARE(left->tone_settings().white, right->tone_settings().white);
    // The colours are those of the picture in the main window, told by a bar, and within the
    // screen.
    for (const ImageView* each : {left, right}) {
      QCOMPARE(each->tone_settings().map, image().tone_settings().map);
      QCOMPARE(each->tone_settings().scale, image().tone_settings().scale);
    }
    for (const ColourBar* bar : window->findChildren<ColourBar*>()) {
      QVERIFY(bar->isVisible());
      QCOMPARE(bar->labels().back(), QString::fromStdString(readable_quantity(
                                         left->tone_settings().white, Dimension::flux, 3)));
    }
    QVERIFY(window->screen()->availableGeometry().width() >= window->width() &&
            window->screen()->availableGeometry().height() >= window->height());
    // Both views show the same part.
    left->set_scale(7);
    left->centre_on(50, 60);
    QVERIFY(std::abs(right->scale() - 7) < 1e-9 && std::abs(right->centre().x() - 50) < 1e-9);
    QTest::mouseClick(right, Qt::LeftButton, {}, right->to_widget(QPointF(52.5, 61.5)).toPoint());
    QVERIFY(selection() == Selection::of_pixel(52, 61));
    QVERIFY(other.document().selection() == selection());
    QVERIFY(until([&] { return other.rays().rays() != nullptr; }));
    // A pixel of half the side gets a quarter of the light, and looks as bright.
    other.document().set_value(
        "camera.sensor.pixel_pitch",
        format_quantity(0.5 * scene().scene.camera.sensor.pixel_pitch, Dimension::length));
    QVERIFY(until([&] {
      return std::abs(right->tone_settings().white / left->tone_settings().white - 0.25) < 1e-6;
    }));
    // In 3-D each sensor shows its picture.
    for (QVTKOpenGLNativeWidget* view : window->findChildren<QVTKOpenGLNativeWidget*>()) {
      vtkPropCollection* const props =
          view->renderWindow()->GetRenderers()->GetFirstRenderer()->GetViewProps();
      bool shown = false;
      for (int i = 0; i < props->GetNumberOfItems(); ++i) {
        auto* const part = vtkActor::SafeDownCast(props->GetItemAsObject(i));
        auto* const drawn = part && part->GetTexture() ? part->GetTexture()->GetInput() : nullptr;
        shown =
            shown || (drawn && drawn->GetDimensions()[0] == scene().scene.camera.sensor.columns);
      }
      QVERIFY(shown);
    }
    const QString folder = qEnvironmentVariable("PLENOFLAME_TOUR");
    if (!folder.isEmpty()) window->grab().save(folder + "/compare.png");
    window->close();
  }

  void typesOfMicrolensesOneAfterTheOther() {
    QVERIFY(open_example("lenslets-30"));
    std::set<int> types;
    for (int i = 0; i < 3; ++i) {
      press(Qt::Key_T, Qt::ControlModifier);
      QVERIFY(selection().kind == Selection::Kind::microlens);
      types.insert(scene().camera.lattice().type(selection().lens));
    }
    QCOMPARE(types.size(), std::size_t{3});
  }

  void viewsHaveTheScreenForThemselves() {
    QVERIFY(open_example("lenslets-30"));
    show_tab(LightFieldPanel::Tab::views);
    const int before = window_->light_field_panel().width();
    child<QWidget>("subApertureView")->setFocus();
    press(Qt::Key_F11);
    QVERIFY(until([&] { return window_->light_field_panel().width() > 2 * before; }));
    QVERIFY(!window_->side_panel().isVisible() && !window_->scene_view().isVisible());
    press(Qt::Key_F11);
    QVERIFY(until([&] { return window_->light_field_panel().width() <= before; }));
    QVERIFY(window_->side_panel().isVisible() && window_->scene_view().isVisible());
  }
};

std::unique_ptr<QObject> plenoflame::desktop::test::make_lecture_test() {
  return std::make_unique<LectureTest>();
}

#include "lecture_test.moc"
