// The display is right at every moment: after a broken file, a refused value, an edit, another
// theme. References: the scene's file, the command's messages, the picture that a run ends with.
#include <QComboBox>
#include <QDir>
#include <QLabel>
#include <QStatusBar>
#include <QTableWidget>
#include <QToolButton>
#include <QTreeView>
#include <cmath>
#include <numeric>

#include "gui_tests.h"
#include "plenoflame/scene/scene_file.h"
#include "plenoflame/volumes/grid_writer.h"
#include "scene_fixture.h"
#include "scenes.h"
#include "widgets/image/light_field_panel.h"
#include "widgets/panels/render_panel.h"
#include "widgets/panels/scene_panel.h"

using namespace plenoflame;
using namespace plenoflame::desktop;
using plenoflame::desktop::test::difference;

class MomentsTest : public test::SceneFixture {
  Q_OBJECT

  /// A scene whose flame is in a file beside it.
  QString scene_of_file() {
    write(file("flame.toml"),
          "[camera]\npreset = \"paper-previous-60x60\"\n\n[[flames]]\nkind = \"vdb\"\n"
          "file = \"burns.vdb\"\nposition = [\"1 m\", \"0 m\", \"0 m\"]\n");
    return file("flame.toml");
  }
  void write_flame_of_file(float kelvin = 1600) {
    VoxelField field;
    field.brick_origins = {{0, 0, 0}};
    field.index_to_world.linear.rows = {{{4e-3, 0, 0}, {0, 4e-3, 0}, {0, 0, 4e-3}}};
    VoxelField hot = field, sooty = field;
    hot.name = "temperature";
    hot.values.assign(512, kelvin);
    sooty.name = "absorption";
    sooty.values.assign(512, 12);
    const std::array<GridOutput, 2> grids{{{&hot, "K"}, {&sooty, "1/m"}}};
    write_grids(file("burns.vdb").toStdString(), grids);
  }
  void open_by_dialog(const QString& path) {
    answer_file_dialog(path);
    press(Qt::Key_O, Qt::ControlModifier);
  }
  double focus() { return session().document().scene().camera.focus.object_distance; }
  QString shown(const char* path) {
    const QModelIndex index = window_->scene_panel().model().find(path, ParameterModel::kValue);
    return index.data().toString();
  }
  static double sum(const Image& image) {
    return std::accumulate(image.pixels.begin(), image.pixels.end(), 0.0);
  }

 private slots:
  void init() { begin(); }
  void cleanup() { end(); }

  // A flame that is made larger or moved keeps what was read of it, unless its file is another one.
  void editedFlameIsReadAgainOnlyWhenItsFileIsAnother() {
    write_flame_of_file();
    QVERIFY(window_->open(scene_of_file()));
    const auto rendered = [this] {
      return until([this] { return session().document().image_is_current(); }) && settled();
    };
    const auto light = [this] { return sum(session().document().image()->channels[0].flux); };
    QVERIFY(rendered());
    const int loads = session().compiler().flames().loads();
    const double before = light();
    session().document().set_value("flames[0].scale", "1.5");
    QVERIFY(rendered());
    QCOMPARE(session().compiler().flames().loads(), loads);
    QVERIFY(light() > 1.5 * before);  // it is wider and thicker
    write_flame_of_file(2000);
    session().document().set_value("flames[0].scale", "1");
    QVERIFY(rendered());
    QCOMPARE(session().compiler().flames().loads(), loads + 1);
    QVERIFY(light() > 2 * before);
  }

  void brokenFlameFileClearsTheSceneBefore() {
    QVERIFY(open_example("lenslets-30"));
    QTest::mouseClick(&image(), Qt::LeftButton, {}, of_pixel(145, 150));
    QVERIFY(until([&] { return session().rays().rays() != nullptr; }));
    const QImage section_before = section().grab().toImage();
    for (const char* broken : {"missing", "damaged"}) {
      if (broken == QString("damaged"))
        write(file("burns.vdb"), QByteArray("\x20\x42\x44\x56\0\0\0\0", 8) + "no grids in here");
      open_by_dialog(scene_of_file());
      QVERIFY(until([&] { return !session().compiler().failure().isEmpty(); }));
      // It is said at every place that cannot be filled, and nothing of the scene before is left.
      const QString said = session().compiler().failure();
      QVERIFY2(said.contains("burns.vdb"), qPrintable(said));
      QVERIFY(!session().compiler().compiled());
      QVERIFY(!session().document().image() && !image().image());
      QVERIFY(!session().rays().rays());
      QCOMPARE(view().flame_temperatures()[1], 0.0);
      QVERIFY(child<QLabel>("sceneViewNotice")->isVisible());
      QCOMPARE(child<QLabel>("sceneViewNotice")->text(), said);
      show_tab(LightFieldPanel::Tab::views);
      QCOMPARE(child<QLabel>("lightFieldNotice")->text(), said);
      show_tab(LightFieldPanel::Tab::raw);
      const QImage scene3d_now = view().picture();
      const QColor ground(scene3d_now.pixel(2, 2));
      int other = 0;
      for (int y = 0; y < scene3d_now.height(); ++y)
        for (int x = 0; x < scene3d_now.width(); ++x)
          other += QColor(scene3d_now.pixel(x, y)) != ground ? 1 : 0;
      QCOMPARE(other, 0);
      QVERIFY(difference(section_before, section().grab().toImage()) > 0.01);
      QVERIFY(!child<QToolButton>("statusLine")->text().contains("preparing"));
      // The row of the file has the message, as other wrong values do.
      const QModelIndex row = window_->scene_panel().model().find("flames[0].file");
      QVERIFY(row.data(ParameterModel::kIsErrorRole).toBool());
      QCOMPARE(row.data(ParameterModel::kMessageRole).toString(), said);
      QVERIFY(!window_->scene_panel().tree().visualRect(row).isEmpty());
      // The command says the same.
      QProcess command;
      command.start(PLENOFLAME_COMMAND, {"render", file("flame.toml"), "-o", file("x.exr")});
      QVERIFY(command.waitForFinished(test::kPatience));
      const QString its = QString::fromUtf8(command.readAllStandardError());
      QVERIFY2(its.contains(said), qPrintable(its + " / " + said));
    }
    // Once the file is there F5 reads it, and all is well.
    write_flame_of_file();
    press(Qt::Key_F5);
    QVERIFY(settled());
    QVERIFY(session().compiler().failure().isEmpty());
    QVERIFY(!child<QLabel>("sceneViewNotice")->isVisible());
    QVERIFY(until([&] { return view().flame_temperatures()[1] > 1500; }));
    QVERIFY(!window_->statusBar()->currentMessage().contains("burns.vdb"));
    const QModelIndex row = window_->scene_panel().model().find("flames[0].file");
    QVERIFY(row.data(ParameterModel::kMessageRole).toString().isEmpty());
  }

  void editThatCannotBeReadMarksWhatIsOlder() {
    write_flame_of_file();
    open_by_dialog(scene_of_file());
    QVERIFY(until([&] { return !session().document().is_empty(); }));
    QVERIFY(settled());
    const auto before = session().compiler().compiled();
    type("flames[0].file", "elsewhere.vdb");
    QVERIFY(until([&] { return !session().compiler().failure().isEmpty(); }));
    QVERIFY(session().compiler().compiled() == before);
    QVERIFY(child<QLabel>("sceneViewNotice")->text().contains("before the last change"));
    QVERIFY(image().badge().contains("older"));
    press(Qt::Key_Z, Qt::ControlModifier);
    QVERIFY(settled());
    QVERIFY(!child<QLabel>("sceneViewNotice")->isVisible());
    QVERIFY(image().badge().isEmpty());
  }

  void oneUndoTakesBackOneEdit() {
    QVERIFY(open_example("lenslets-30"));
    const double first = focus();
    const QString first_text = shown("camera.focus.object_distance");
    type("camera.focus.object_distance", "1.2 m");
    type("camera.focus.object_distance", "1.3 m");
    type("camera.focus.object_distance", "-3 m");
    QCOMPARE(shown("camera.focus.object_distance"), QString("-3 m"));
    press(Qt::Key_Z, Qt::ControlModifier);
    QCOMPARE(focus(), 1.3);
    QCOMPARE(shown("camera.focus.object_distance"), QString("1.3 m"));
    press(Qt::Key_Z, Qt::ControlModifier);
    QCOMPARE(focus(), 1.2);
    press(Qt::Key_Z, Qt::ControlModifier);
    QCOMPARE(focus(), first);
    QCOMPARE(shown("camera.focus.object_distance"), first_text);
    QVERIFY(!session().document().can_undo());
    // A refused value alone can be taken back, too.
    type("camera.focus.object_distance", "nonsense");
    QVERIFY(window_->findChild<QAction*>("actionUndo")->isEnabled());
    press(Qt::Key_Z, Qt::ControlModifier);
    QCOMPARE(shown("camera.focus.object_distance"), first_text);
    QVERIFY(!window_->findChild<QAction*>("actionUndo")->isEnabled());
  }

  void savingSaysWhatWasNotTaken() {
    QVERIFY(open_example("lenslets-30"));
    type("camera.focus.object_distance", "1.25 m");
    type("render.samples", "-7");
    answer_file_dialog(file("mine.toml"));
    press(Qt::Key_S, Qt::ControlModifier | Qt::ShiftModifier);
    const QString said = window_->statusBar()->currentMessage();
    QVERIFY2(said.contains("mine.toml saved") && said.contains("not taken") &&
                 said.contains("render.samples = -7"),
             qPrintable(said));
    QCOMPARE(read_scene_file(file("mine.toml").toStdString()).scene.camera.focus.object_distance,
             1.25);
    press(Qt::Key_S, Qt::ControlModifier);
    QVERIFY(window_->statusBar()->currentMessage().contains("not taken"));
    // A text that is being typed when the keys for saving come is saved.
    ScenePanel& panel = window_->scene_panel();
    panel.reveal("camera.focus.object_distance");
    QTest::keyClick(&panel.tree(), Qt::Key_F2);
    auto* editor = panel.tree().findChild<QLineEdit*>();
    QVERIFY(editor);
    editor->selectAll();
    QTest::keyClicks(editor, "1.5 m");
    QTest::keyClick(editor, Qt::Key_S, Qt::ControlModifier);
    QVERIFY(until([&] { return !window_->isWindowModified() && focus() == 1.5; }));
    QCOMPARE(read_scene_file(file("mine.toml").toStdString()).scene.camera.focus.object_distance,
             1.5);
  }

  void pictureStaysUntilABetterOneIsThere() {
    QVERIFY(open_example("lenslets-30"));
    session().document().set_value("render.samples", "1024", {});
    QVERIFY(settled());
    RenderJob& job = session().render();
    std::vector<std::shared_ptr<const LightField>> pictures;
    std::vector<double> fractions;
    QObject here;
    QObject::connect(&session().document(), &Document::image_changed, &here,
                     [&] { pictures.push_back(session().document().image()); });
    QObject::connect(&job, &RenderJob::progressed, &here,
                     [&] { fractions.push_back(job.status().fraction); });
    // An edit: the old picture is marked as such, and the first new one is whole and coarse.
    const auto before = session().document().image();
    type("flames[0].scale", "0.6");
    QVERIFY(session().document().image() == before);
    QVERIFY(image().badge().contains("older"));
    QVERIFY(until([&] { return !pictures.empty(); }));
    QVERIFY(image().badge().isEmpty());
    QVERIFY(settled());
    const Image& final = pictures.back()->channels[0].flux;
    QVERIFY(pictures.size() >= 3);
    for (const auto& picture : pictures) {
      const Image& flux = picture->channels[0].flux;
      QVERIFY2(std::fabs(sum(flux) / sum(final) - 1) < 0.2,
               qPrintable(QString::number(sum(flux) / sum(final))));
    }
    QVERIFY(pictures.front()->samples < pictures.back()->samples);
    // The bar is of the whole run: it never falls back.
    for (std::size_t i = 1; i < fractions.size(); ++i) QVERIFY(fractions[i] >= fractions[i - 1]);
    QCOMPARE(fractions.back(), 1.0);
    for (const RenderJob::CurvePoint& point : job.curve()) QVERIFY(point.error > 0);
    // The same once more: nothing worse than what is there is shown on the way.
    pictures.clear();
    const Image kept = final;
    press(Qt::Key_F5);
    QVERIFY(session().document().image_is_current());
    QVERIFY(image().badge().isEmpty());
    QVERIFY(settled());
    QVERIFY(!pictures.empty());
    for (const auto& picture : pictures) QVERIFY(picture->channels[0].flux.pixels == kept.pixels);
    // More samples: the picture that there is gets better, tile by tile.
    pictures.clear();
    QTest::mouseClick(child<QWidget>("renderFiner"), Qt::LeftButton);
    QVERIFY(settled());
    for (const auto& picture : pictures) QVERIFY(picture->samples > 1024);
  }

  // The picture of one scene is seen until there is one of the next, where the camera has the same
  // number of pixels.
  void pictureOfTheSceneBeforeIsSeenMeanwhile() {
    write(file("one.toml"), test::small_scene_text().c_str());
    write(file("two.toml"), QByteArray(test::small_scene_text().c_str()).replace("-29 mm", "9 mm"));
    open_by_dialog(file("one.toml"));
    QVERIFY(until([&] { return session().document().image_is_current(); }) && settled());
    const QImage before = image().grab().toImage();
    QVERIFY(image().badge().isEmpty());
    open_by_dialog(file("two.toml"));
    QVERIFY(!session().document().image());  // nothing can be exported yet
    QVERIFY(image().image());
    QCOMPARE(image().badge(), QString("of the scene before"));
    const double other = difference(before, image().grab().toImage());
    QVERIFY2(other > 0 && other < 0.05, qPrintable(QString::number(other)));  // its badge
    QVERIFY(until([&] { return session().document().image_is_current(); }) && settled());
    QVERIFY(image().badge().isEmpty());
    QVERIFY(difference(before, image().grab().toImage()) > 0.05);
    // Another number of pixels: the picture has no place there.
    type("camera.sensor.columns", "190");
    QVERIFY(!image().image() && !session().document().image());
    QVERIFY(until([&] { return session().document().image_is_current(); }) && settled());
    QCOMPARE(image().image()->width(), 190);
    open_by_dialog(file("one.toml"));
    QVERIFY(!image().image());
    QVERIFY(until([&] { return session().document().image_is_current(); }) && settled());
    // No picture follows where the scene cannot be prepared.
    write(file("three.toml"),
          QByteArray(test::small_scene_text().c_str())
              .replace("preset = \"paper-layered\"", "kind = \"vdb\"\nfile = \"none.vdb\""));
    open_by_dialog(file("three.toml"));
    QVERIFY(until([&] { return !session().compiler().failure().isEmpty(); }));
    QVERIFY(!image().image() && image().badge().isEmpty());
  }

  void errorIsNotToldBeforeItIsKnown() {
    QVERIFY(open_example("lenslets-30"));
    RenderJob& job = session().render();
    QStringList told;
    QObject here;
    QObject::connect(&job, &RenderJob::progressed, &here,
                     [&] { told << child<QLabel>("renderError")->text(); });
    type("flames[0].scale", "0.6");
    QVERIFY(settled());
    QVERIFY(!told.isEmpty() && told.back().contains('%'));
    for (const QString& text : told) QVERIFY2(!text.startsWith("0 %"), qPrintable(text));
  }

  void themeChangesWhatIsDrawnAlready() {
    QVERIFY(open_example("lenslets-30"));
    QTest::mouseClick(&image(), Qt::LeftButton, {}, of_pixel(145, 150));
    QVERIFY(until([&] { return session().rays().rays() != nullptr; }));
    auto* table = child<QTableWidget>("raysTable");
    const auto far = [](const QColor& a, const QColor& b) {
      return std::abs(a.lightness() - b.lightness()) > 40;
    };
    for (int turn = 0; turn < 3; ++turn) {
      QVERIFY(click_menu({"View", "Dark theme"}));
      QTest::qWait(50);
      for (QToolButton* button : window_->findChildren<QToolButton*>()) {
        const QPalette palette = button->palette();
        QVERIFY2(far(palette.color(QPalette::ButtonText), palette.color(QPalette::Button)),
                 qPrintable(button->text()));
        if (!button->isVisible() || button->text().isEmpty() || !button->isEnabled()) continue;
        // As it is drawn: darkest and lightest points of the button differ.
        const QImage drawn = button->grab().toImage();
        int low = 255, high = 0;
        for (int y = 0; y < drawn.height(); ++y)
          for (int x = 0; x < drawn.width(); ++x) {
            low = std::min(low, QColor(drawn.pixel(x, y)).lightness());
            high = std::max(high, QColor(drawn.pixel(x, y)).lightness());
          }
        QVERIFY2(high - low > 60, qPrintable(button->text()));
      }
      const QColor ground = table->palette().color(QPalette::Base);
      for (int row = 0; row < table->rowCount(); ++row)
        QVERIFY(far(table->item(row, 2)->foreground().color(), ground));
      QVERIFY(far(table->palette().color(QPalette::Text), ground));
    }
  }

  void nothingStaleIsSaid() {
    QVERIFY(open_example("lenslets-30"));
    auto* bar = window_->statusBar();
    // An error that is solved goes from the status bar.
    type("flames[0].position", "-1 m, 0 m, 0 m");
    QVERIFY(until([&] { return bar->currentMessage().contains("behind"); }));
    press(Qt::Key_Z, Qt::ControlModifier);
    QVERIFY(until([&] { return !bar->currentMessage().contains("behind"); }));
    QVERIFY(settled());
    // So does the distance when measuring ends.
    QToolButton* measure = nullptr;
    for (QToolButton* button : window_->findChildren<QToolButton*>())
      if (button->defaultAction() == window_->findChild<QAction*>("measure")) measure = button;
    QVERIFY(measure);
    QTest::mouseClick(measure, Qt::LeftButton);
    const QPoint middle = scene3d()->rect().center();
    QTest::qWait(80);
    for (const QPoint& place : {middle - QPoint(40, 20), middle + QPoint(40, 0)}) {
      mouse(scene3d(), QEvent::MouseMove, place, Qt::NoButton);
      QTest::mouseClick(scene3d(), Qt::LeftButton, {}, place);
      QTest::qWait(60);
    }
    QVERIFY(until([&] { return bar->currentMessage().contains("distance"); }));
    QTest::mouseClick(measure, Qt::LeftButton);
    QVERIFY(bar->currentMessage().isEmpty());
    // The sum of the rays says why it is not the picture's flux.
    QTest::mouseClick(&image(), Qt::LeftButton, {}, of_pixel(145, 150));
    QVERIFY(until([&] { return session().rays().rays() != nullptr; }));
    const QString title = child<QLabel>("raysTitle")->text();
    QVERIFY2(title.contains("rays") && title.contains("in the picture") &&
                 title.contains(QString::number(session().document().image()->samples)),
             qPrintable(title));
    QVERIFY(child<QTableWidget>("raysTable")->horizontalHeaderItem(7)->text().contains("W/(m"));
    // Another document: what was known of the run before is gone.
    QVERIFY(window_->open_example("paper-previous-60x60"));
    QCOMPARE(session().render().statistics().lenses, 0.0);
    QVERIFY(session().render().curve().empty());
    QVERIFY(!session().light_field().refocused().image);
  }
};

std::unique_ptr<QObject> plenoflame::desktop::test::make_moments_test() {
  return std::make_unique<MomentsTest>();
}

#include "moments_test.moc"
