// The window, driven by clicks and keys as a person would.
#include <QDir>
#include <QDirIterator>
#include <QFile>
#include <QFileInfo>
#include <QFrame>
#include <QLabel>
#include <QPushButton>
#include <QScreen>
#include <QScrollArea>
#include <QTableWidget>
#include <QToolButton>
#include <QTreeView>
#include <set>

#include "gui_tests.h"
#include "widgets/controls/tool_row.h"
#include "widgets/panels/rays_panel.h"
#include "widgets/panels/render_panel.h"
#include "widgets/panels/scene_panel.h"
#include "widgets/scene/scene_view.h"
#include "widgets/scene/section_view.h"
#include "window_fixture.h"

using namespace plenoflame;
using namespace plenoflame::desktop;
using plenoflame::desktop::test::difference;

class WindowTest : public test::WindowFixture {
  Q_OBJECT

 private slots:
  void init() { begin(); }
  void cleanup() { end(); }

  void welcomeOpensAnExampleInOneClick() {
    auto* button = child<QWidget>("example-lenslets-30");
    QVERIFY(button && button->isVisible());
    QTest::mouseClick(button, Qt::LeftButton);
    QVERIFY(settled());
    QVERIFY(image().isVisible());
    QVERIFY(window_->session().document().image_is_current());
    // The picture is neither black nor empty.
    const QImage shown = image().grab().toImage();
    int lit = 0;
    for (int y = 0; y < shown.height(); y += 3)
      for (int x = 0; x < shown.width(); x += 3)
        lit += QColor(shown.pixel(x, y)).value() > 128 ? 1 : 0;
    QVERIFY(lit > 200);
  }

  void everythingOfTheToolbarsIsSeenAtEachSize() {
    // A window as the program makes it, with no settings from before.
    MainWindow fresh(std::make_unique<QSettings>(file("none.ini"), QSettings::IniFormat), {});
    fresh.set_unattended(true);
    fresh.show();
    QVERIFY(QTest::qWaitForWindowExposed(&fresh));
    QVERIFY(fresh.open_example("lenslets-30"));
    QVERIFY(until([&] { return fresh.is_settled(); }));
    const QStringList of_measured{"shownPicture", "blinkPictures"};
    QVERIFY(fresh.scene_view().findChildren<QToolButton*>().size() > 10);
    for (const QSize size : {QSize(1500, 950), QSize(1366, 768), QSize(1280, 720)}) {
      for (const QWidget* panel : {static_cast<QWidget*>(&fresh.scene_view()),
                                   static_cast<QWidget*>(&fresh.image_panel())})
        QCOMPARE(cut_tool(fresh, size, *panel, of_measured), QString());
      // Names and values of the tree, without what has no room.
      const QTreeView& tree = fresh.scene_panel().tree();
      QVERIFY(tree.isColumnHidden(2) || tree.width() > 400);
    }
  }

  void toolbarsHaveOneRowAndTheRestBehindTheirLastButton() {
    QTest::mouseClick(child<QWidget>("example-lenslets-30"), Qt::LeftButton);
    QVERIFY(settled());
    const auto lines = [](const ToolRow& row) {
      std::set<int> heights;
      for (const QWidget* tool : row.findChildren<QWidget*>(QString(), Qt::FindDirectChildrenOnly))
        if (tool->isVisible() && !tool->isWindow()) heights.insert(tool->geometry().center().y());
      return heights.empty() ? 0 : *heights.rbegin() - *heights.begin();
    };
    for (const QSize size : {QSize(1280, 720), QSize(1366, 768), QSize(1920, 1080)}) {
      window_->resize(size);
      QVERIFY(until([&] { return window_->size() == size; }));
      QTest::qWait(50);
      for (const auto* row : window_->findChildren<ToolRow*>())
        QVERIFY2(
            lines(*row) < 6,
            qPrintable(QString("%1 %2 %3").arg(size.width()).arg(row->width()).arg(lines(*row))));
      QTabBar& tabs = *window_->light_field_panel().tabs().tabBar();
      QCOMPARE(tabs.count(), 6);
      for (int i = 0; i < tabs.count(); ++i)
        QVERIFY2(
            tabs.tabRect(i).width() > tabs.fontMetrics().horizontalAdvance(tabs.tabText(i)) + 4,
            qPrintable(tabs.tabText(i)));
    }
    window_->resize(1366, 768);
    QTest::qWait(50);
    for (const auto& [button, tools] : {std::pair<const char*, QStringList>{
                                            "moreOfScene", {"flameExposure", "flameCut", "alongX"}},
                                        {"moreOfImage", {"white", "scale"}}}) {
      QTest::mouseClick(child<QToolButton>(button), Qt::LeftButton);
      auto* const popup = child<QFrame>(qPrintable(QString(button) + "Popup"));
      QVERIFY(popup->isVisible());
      for (const QString& name : tools) {
        const auto* const tool = child<QWidget>(qPrintable(name));
        QVERIFY2(tool->isVisible() && tool->window() == popup &&
                     tool->visibleRegion().boundingRect() == tool->rect(),
                 qPrintable(name));
      }
      QVERIFY(QGuiApplication::primaryScreen()->geometry().contains(popup->geometry()));
      QTest::keyClick(popup, Qt::Key_Escape);
      QVERIFY(!popup->isVisible());
    }
    // The section has no use for those of the flame.
    for (auto* tool : window_->findChildren<QToolButton*>())
      if (tool->defaultAction() == child<QAction>("viewSection"))
        QTest::mouseClick(tool, Qt::LeftButton);
    QVERIFY(!child<QWidget>("moreOfScene")->isVisible());
    QVERIFY(!child<QWidget>("flameDrawing")->isVisible());
  }

  // On the screen itself, not in a picture that the window makes of itself.
  void welcomePageIsWholeOnTheScreen() {
    QTest::qWait(500);
    const QWidget* const page = child<QWidget>("welcomePage");
    const QRect place(page->mapToGlobal(QPoint(0, 0)), page->size());
    const QImage seen = QGuiApplication::primaryScreen()
                            ->grabWindow(0, place.x(), place.y(), place.width(), place.height())
                            .toImage();
    const QColor ground = page->palette().color(QPalette::Window);
    QVERIFY(seen.width() > 1000);
    // Beside its lists there is nothing but its ground.
    for (int y = 2; y < seen.height() - 2; ++y)
      for (const int x : {2, 20, 40, seen.width() - 40, seen.width() - 20, seen.width() - 2})
        QVERIFY2(seen.pixelColor(x, y) == ground, qPrintable(QString("%1, %2").arg(x).arg(y)));
  }

  // Every example is on the page, with a picture, as it is in its file.
  void welcomePageHasEveryExample() {
    const QDir folder(PLENOFLAME_EXAMPLES);
    int seen = 0;
    for (const QString& name : folder.entryList({"*.toml"}, QDir::Files)) {
      QFile file(folder.filePath(name));
      QVERIFY(file.open(QIODevice::ReadOnly));
      const QByteArray text = file.readAll();
      auto* const button =
          child<QPushButton>(qPrintable("example-" + QFileInfo(name).completeBaseName()));
      QVERIFY2(button && button->isVisible(), qPrintable(name));
      QVERIFY2(!button->icon().pixmap(48, 48).isNull(), qPrintable(name));
      QFile kept(":/examples/" + name);
      QVERIFY2(kept.open(QIODevice::ReadOnly) && kept.readAll() == text, qPrintable(name));
      ++seen;
    }
    QVERIFY(seen > 20);
  }

  // Flames that an example reads are made as the commands at its head make them.
  void exampleWithAFlameOfItsOwnOpensByAClick() {
    qputenv("XDG_DATA_HOME", file("data").toUtf8());
    for (const auto& [name, flame] : {std::pair("flickering", "/flickering_#.vdb"),
                                      {"candle-blue", "/candle-blue.vdb"},
                                      {"quartz-tube", "/candle.vdb"}}) {
      QVERIFY(click_menu({"File", "Welcome page"}));
      auto* const button = child<QPushButton>(qPrintable(QString("example-") + name));
      child<QScrollArea>("welcomeExamples")->ensureWidgetVisible(button);
      QTest::mouseClick(button, Qt::LeftButton);
      QVERIFY(until(
          [&] {
            const auto& flames = session().document().scene().flames;
            return flames.size() == 1 && flames[0].file.ends_with(flame);
          },
          60000));
      QVERIFY(until([&] { return session().compiler().is_current(); }, 60000));
      QVERIFY2(session().compiler().failure().isEmpty(),
               qPrintable(session().compiler().failure()));
      QVERIFY(session().compiler().compiled()->medium);
    }
    // Voxel by voxel: what the program says of both files is the same, but for their names.
    QDirIterator made(file("data"), {"*.vdb"}, QDir::Files, QDirIterator::Subdirectories);
    QStringList files;
    while (made.hasNext()) files << made.next();
    QCOMPARE(files.size(), 5);  // three moments, two candles
    const auto told = [&](const QString& path) {
      return run(PLENOFLAME_COMMAND, {"info", path, "--json"}).remove(path);
    };
    const auto same = [&](const QString& named, const QStringList& options) {
      const QString reference = file("reference.vdb");
      run(PLENOFLAME_COMMAND, QStringList{"flame", "candle", "-o", reference} + options);
      for (const QString& path : files)
        if (path.endsWith("/" + named)) return told(path) == told(reference);
      return false;
    };
    QVERIFY(same("candle.vdb", {}));
    QVERIFY(same("candle-blue.vdb", {"--line", "ch=10 kW/m^3", "--line", "c2_517=5 kW/m^3"}));
    QVERIFY(same("flickering_1.vdb", {"--set", "height=28 mm"}));
    QVERIFY(same("flickering_3.vdb", {"--set", "height=38 mm"}));
    QVERIFY(!told(files.front()).isEmpty());
    qunsetenv("XDG_DATA_HOME");
  }

  void welcomePageCoversEmptyPanels() {
    const auto covered = [this](const char* name) {
      const QWidget* const panel = dock(name);
      const QPoint middle = panel->mapTo(window_.get(), panel->rect().center());
      const QWidget* at = window_->childAt(middle);
      while (at && at->objectName() != "welcomePage") at = at->parentWidget();
      return at != nullptr;
    };
    for (const char* name : {"sceneGroup", "renderGroup", "scene3d", "rawImage"})
      QVERIFY2(covered(name), name);
    QVERIFY(window_->open_example("lenslets-30") && settled());
    for (const char* name : {"sceneGroup", "renderGroup", "scene3d", "rawImage"})
      QVERIFY2(!covered(name), name);
  }

  void clickedPixelShowsItsRaysEverywhere() {
    QVERIFY(window_->open_example("lenslets-30"));
    QVERIFY(settled());
    // The brightest pixel certainly has rays that reach the flame.
    const LightField& field = *window_->session().document().image();
    int column = 0, row = 0;
    for (int y = 0; y < field.sensor_height; ++y)
      for (int x = 0; x < field.sensor_width; ++x)
        if (field.channels[0].flux.at(x, y) > field.channels[0].flux.at(column, row)) {
          column = x;
          row = y;
        }
    QVERIFY(until([&] { return !window_->scene_view().picture().isNull(); }));
    const QImage section_before = window_->section_view().grab().toImage();
    const QImage scene_before = window_->scene_view().picture();
    QElapsedTimer since;
    since.start();
    image().set_scale(8);
    image().centre_on(column, row);
    QTest::mouseClick(&image(), Qt::LeftButton, {}, of_pixel(column, row));
    QVERIFY(until([&] { return window_->session().rays().rays() != nullptr; }));
    qInfo("rays after %lld ms", since.elapsed());
    const Selection& selection = window_->session().document().selection();
    QCOMPARE(selection.column, column);
    QCOMPARE(selection.row, row);
    auto* table = child<QTableWidget>("raysTable");
    QVERIFY(table->rowCount() > 8);
    QVERIFY(child<QTableWidget>("surfacesTable")->rowCount() >= 4);
    QVERIFY(difference(section_before, window_->section_view().grab().toImage()) > 1e-3);
    QTest::qWait(100);
    QVERIFY(difference(scene_before, window_->scene_view().picture()) > 1e-4);
    // Arrow keys go on from there.
    QTest::keyClick(&image(), Qt::Key_Right);
    QCOMPARE(window_->session().document().selection().column, column + 1);
    QTest::keyClick(window_.get(), Qt::Key_Escape);
    QVERIFY(window_->session().document().selection().kind == Selection::Kind::none);
    QCOMPARE(table->rowCount(), 0);
    // Shift: the microlens.
    QTest::mouseClick(&image(), Qt::LeftButton, Qt::ShiftModifier, of_pixel(column, row));
    QVERIFY(until([&] { return window_->session().rays().rays() != nullptr; }));
    QVERIFY(window_->session().rays().rays()->pixels.size() > 20);
  }

  void clickIntoTheFlameLightsPixels() {
    QVERIFY(window_->open_example("lenslets-30"));
    QVERIFY(settled());
    auto* scene3d = child<QWidget>("scene3d");
    QVERIFY(until([&] { return window_->scene_view().flame_temperatures()[1] > 0; }));
    QTest::keyClick(window_.get(), Qt::Key_2, Qt::ControlModifier);
    QTest::qWait(100);
    QTest::mouseClick(scene3d, Qt::LeftButton, {}, scene3d->rect().center());
    QVERIFY(window_->session().document().selection().kind == Selection::Kind::point);
    QVERIFY(until([&] { return window_->session().rays().rays() != nullptr; }));
    QVERIFY(!window_->session().rays().rays()->pixels.empty());
  }

  void editedValueIsTypedUndoneAndRefused() {
    QVERIFY(window_->open_example("lenslets-30"));
    QVERIFY(settled());
    const double before = window_->session().document().scene().camera.focus.object_distance;
    type("camera.focus.object_distance", "1.5 m");
    QVERIFY(until(
        [&] { return window_->session().document().scene().camera.focus.object_distance == 1.5; }));
    QVERIFY(window_->isWindowModified());
    QVERIFY(settled());
    QTest::keyClick(window_.get(), Qt::Key_Z, Qt::ControlModifier);
    QCOMPARE(window_->session().document().scene().camera.focus.object_distance, before);
    QVERIFY(!window_->isWindowModified());
    type("camera.focus.object_distance", "1.5");
    auto* message = child<QLabel>("sceneMessage");
    QVERIFY(until([&] { return message->isVisible(); }));
    QCOMPARE(window_->session().document().scene().camera.focus.object_distance, before);
    QVERIFY(message->text().contains("unit"));
  }

  void renderingIsPausedAndResumedByButtons() {
    QVERIFY(window_->open_example("lenslets-30"));
    QVERIFY(settled());
    window_->session().document().set_value("render.samples", "20000");
    RenderJob& job = window_->session().render();
    QVERIFY(until([&] { return job.state() == RenderJob::State::running; }));
    auto* pause = child<QPushButton>("renderPause");
    QTest::mouseClick(pause, Qt::LeftButton);
    QVERIFY(job.state() == RenderJob::State::paused);
    QCOMPARE(pause->text(), QString("Resume"));
    QTest::mouseClick(pause, Qt::LeftButton);
    QVERIFY(job.state() == RenderJob::State::running);
    QTest::mouseClick(child<QPushButton>("renderStop"), Qt::LeftButton);
    QVERIFY(job.state() == RenderJob::State::idle);
  }

  void zoomKeepsThePlaceUnderThePointer() {
    QVERIFY(window_->open_example("lenslets-30"));
    QVERIFY(settled());
    const QPointF place(200, 150), before = image().to_image(place);
    const double scale = image().scale();
    QWheelEvent wheel(place, image().mapToGlobal(place.toPoint()), {}, {0, 240}, Qt::NoButton, {},
                      Qt::NoScrollPhase, false);
    QApplication::sendEvent(&image(), &wheel);
    QVERIFY(std::fabs(image().scale() / scale - 2) < 1e-9);
    const QPointF after = image().to_image(place);
    QVERIFY(std::hypot(after.x() - before.x(), after.y() - before.y()) * image().scale() < 1e-6);
    QTest::keyClick(&image(), Qt::Key_F);
    QCOMPARE(image().scale(), scale);
  }

  void sceneFitsFromTheFlameToAMicrolens() {
    QVERIFY(window_->open_example("paper-previous-60x60"));
    QVERIFY(until([&] { return window_->scene_view().flame_temperatures()[1] > 0; }));
    SceneView& view = window_->scene_view();
    window_->findChild<QAction*>("shortenGaps")->setChecked(false);  // to scale
    double height = 0;
    for (const SceneView::Part part : {SceneView::Part::scene, SceneView::Part::camera,
                                       SceneView::Part::array, SceneView::Part::pixel}) {
      view.show_part(part);
      const QImage picture = view.picture();
      QVERIFY(height == 0 || view.view_height() < height);
      height = view.view_height();
      // Near and far leave room around what is looked at, whatever its size.
      const auto [near, far] = view.clipping_range();
      QVERIFY(near < 0.1 * height / 0.4 && far > 10 * height);
      const QRgb corner = picture.pixel(2, picture.height() / 2);
      int other = 0;
      for (int y = picture.height() / 5; y < picture.height() * 4 / 5; y += 4)
        for (int x = 0; x < picture.width(); x += 4) other += picture.pixel(x, y) != corner ? 1 : 0;
      // Without cube and bar. The share is one of a square as wide as the view, which may be far
      // higher than the scene.
      QVERIFY2(other > picture.width() * picture.width() / 16 / 400,
               qPrintable(QString("%1 in part %2").arg(other).arg(static_cast<int>(part))));
    }
  }

  void exportedRaysAreAFile() {
    QVERIFY(window_->open_example("lenslets-30"));
    QVERIFY(settled());
    QTest::mouseClick(&image(), Qt::LeftButton, {}, of_pixel(150, 150));
    QVERIFY(until([&] { return window_->session().rays().rays() != nullptr; }));
    const QString path = folder_->filePath("rays.csv");
    answer_file_dialog(path);
    QTest::mouseClick(child<QPushButton>("exportRays"), Qt::LeftButton);
    QVERIFY(written());
    QFile file(path);
    QVERIFY2(file.open(QIODevice::ReadOnly), qPrintable(window_->last_message()));
    QVERIFY(file.readAll().count('\n') > 30);
  }
};

std::unique_ptr<QObject> plenoflame::desktop::test::make_window_test() {
  return std::make_unique<WindowTest>();
}

#include "window_test.moc"
