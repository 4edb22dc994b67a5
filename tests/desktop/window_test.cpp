// The window, driven by clicks and keys as a person would.
#include <QVTKOpenGLNativeWidget.h>
#include <QApplication>
#include <QFile>
#include <QFileDialog>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QSurfaceFormat>
#include <QTableWidget>
#include <QTemporaryDir>
#include <QTest>
#include <QTimer>
#include <QTreeView>
#include <cmath>

#include "plenoflame/image/light_field.h"
#include "widgets/image_panel.h"
#include "widgets/image_view.h"
#include "widgets/main_window.h"
#include "widgets/rays_panel.h"
#include "widgets/render_panel.h"
#include "widgets/scene_panel.h"
#include "widgets/scene_view.h"
#include "widgets/section_view.h"

using namespace plenoflame;
using namespace plenoflame::desktop;

namespace {

/// Share of the pixels of two pictures that differ visibly.
double difference(const QImage& a, const QImage& b) {
  if (a.size() != b.size() || a.isNull()) return 1;
  int differing = 0;
  for (int y = 0; y < a.height(); ++y)
    for (int x = 0; x < a.width(); ++x) {
      const QColor p(a.pixel(x, y)), q(b.pixel(x, y));
      const int distance = std::abs(p.red() - q.red()) + std::abs(p.green() - q.green()) +
                           std::abs(p.blue() - q.blue());
      differing += distance > 24 ? 1 : 0;
    }
  return static_cast<double>(differing) / (a.width() * a.height());
}

}  // namespace

class WindowTest : public QObject {
  Q_OBJECT

 private:
  std::unique_ptr<QTemporaryDir> folder_;
  std::unique_ptr<MainWindow> window_;

  std::unique_ptr<QSettings> settings() const {
    return std::make_unique<QSettings>(folder_->filePath("settings.ini"), QSettings::IniFormat);
  }
  bool settled() {
    return QTest::qWaitFor([this] { return window_->is_settled(); }, 60000);
  }
  ImageView& image() { return window_->image_panel().view(); }
  QPoint of_pixel(int column, int row) {
    return image().to_widget(QPointF(column + 0.5, row + 0.5)).toPoint();
  }
  template <class Widget>
  Widget* child(const char* name) {
    return window_->findChild<Widget*>(name);
  }
  /// Types a name into the file dialog that opens next.
  void answer_file_dialog(const QString& path) {
    QTimer::singleShot(300, this, [path] {
      for (QWidget* widget : QApplication::topLevelWidgets())
        if (auto* dialog = qobject_cast<QFileDialog*>(widget)) {
          auto* edit = dialog->findChild<QLineEdit*>("fileNameEdit");
          edit->setText(path);
          QTest::keyClick(edit, Qt::Key_Return);
          return;
        }
    });
  }

 private slots:
  void init() {
    folder_ = std::make_unique<QTemporaryDir>();
    window_ = std::make_unique<MainWindow>(settings(), folder_->filePath("recovery").toStdString());
    window_->set_unattended(true);
    window_->resize(1400, 900);
    window_->show();
    QVERIFY(QTest::qWaitForWindowExposed(window_.get()));
    QApplication::setActiveWindow(window_.get());  // nobody else does: there is no window manager
  }
  void cleanup() { window_.reset(); }

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
    QVERIFY(QTest::qWaitFor([&] { return !window_->scene_view().picture().isNull(); }));
    const QImage section_before = window_->section_view().grab().toImage();
    const QImage scene_before = window_->scene_view().picture();
    QElapsedTimer since;
    since.start();
    image().set_scale(8);
    image().centre_on(column, row);
    QTest::mouseClick(&image(), Qt::LeftButton, {}, of_pixel(column, row));
    QVERIFY(QTest::qWaitFor([&] { return window_->session().rays().rays() != nullptr; }));
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
    QVERIFY(QTest::qWaitFor([&] { return window_->session().rays().rays() != nullptr; }));
    QVERIFY(window_->session().rays().rays()->pixels.size() > 20);
  }

  void clickIntoTheFlameLightsPixels() {
    QVERIFY(window_->open_example("lenslets-30"));
    QVERIFY(settled());
    auto* scene3d = child<QWidget>("scene3d");
    QVERIFY(QTest::qWaitFor([&] { return window_->scene_view().flame_temperatures()[1] > 0; }));
    QTest::keyClick(window_.get(), Qt::Key_2, Qt::ControlModifier);
    QTest::qWait(100);
    QTest::mouseClick(scene3d, Qt::LeftButton, {}, scene3d->rect().center());
    QVERIFY(window_->session().document().selection().kind == Selection::Kind::point);
    QVERIFY(QTest::qWaitFor([&] { return window_->session().rays().rays() != nullptr; }));
    QVERIFY(!window_->session().rays().rays()->pixels.empty());
  }

  void editedValueIsTypedUndoneAndRefused() {
    QVERIFY(window_->open_example("lenslets-30"));
    QVERIFY(settled());
    ScenePanel& panel = window_->scene_panel();
    const double before = window_->session().document().scene().camera.focus.object_distance;
    const auto type = [&](const char* path, const QString& text) {
      panel.reveal(path);
      QTest::keyClick(&panel.tree(), Qt::Key_F2);
      auto* editor = panel.tree().findChild<QLineEdit*>();
      QVERIFY(editor);
      editor->selectAll();
      QTest::keyClicks(editor, text);
      QTest::keyClick(editor, Qt::Key_Return);
    };
    type("camera.focus.object_distance", "1.5 m");
    QTRY_COMPARE(window_->session().document().scene().camera.focus.object_distance, 1.5);
    QVERIFY(window_->isWindowModified());
    QVERIFY(settled());
    QTest::keyClick(window_.get(), Qt::Key_Z, Qt::ControlModifier);
    QCOMPARE(window_->session().document().scene().camera.focus.object_distance, before);
    QVERIFY(!window_->isWindowModified());
    type("camera.focus.object_distance", "1.5");
    auto* message = child<QLabel>("sceneMessage");
    QTRY_VERIFY(message->isVisible());
    QCOMPARE(window_->session().document().scene().camera.focus.object_distance, before);
    QVERIFY(message->text().contains("unit"));
  }

  void renderingIsPausedAndResumedByButtons() {
    QVERIFY(window_->open_example("lenslets-30"));
    QVERIFY(settled());
    window_->session().document().set_value("render.samples", "20000");
    RenderJob& job = window_->session().render();
    QVERIFY(QTest::qWaitFor([&] { return job.state() == RenderJob::State::running; }));
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
    QVERIFY(
        QTest::qWaitFor([&] { return window_->scene_view().flame_temperatures()[1] > 0; }, 60000));
    SceneView& view = window_->scene_view();
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
      for (int y = 0; y < picture.height(); y += 4)
        for (int x = 0; x < picture.width(); x += 4) other += picture.pixel(x, y) != corner ? 1 : 0;
      QVERIFY(other > picture.width() * picture.height() / 16 / 50);
    }
  }

  void exportedRaysAreAFile() {
    QVERIFY(window_->open_example("lenslets-30"));
    QVERIFY(settled());
    QTest::mouseClick(&image(), Qt::LeftButton, {}, of_pixel(150, 150));
    QVERIFY(QTest::qWaitFor([&] { return window_->session().rays().rays() != nullptr; }));
    const QString path = folder_->filePath("rays.csv");
    answer_file_dialog(path);
    QTest::mouseClick(child<QPushButton>("exportRays"), Qt::LeftButton);
    QFile file(path);
    QVERIFY2(file.open(QIODevice::ReadOnly), qPrintable(window_->last_message()));
    QVERIFY(file.readAll().count('\n') > 30);
  }
};

int main(int argc, char** argv) {
  QSurfaceFormat::setDefaultFormat(QVTKOpenGLNativeWidget::defaultFormat());
  QApplication::setAttribute(Qt::AA_DontUseNativeDialogs);
  QApplication application(argc, argv);
  WindowTest test;
  return QTest::qExec(&test, argc, argv);
}

#include "window_test.moc"
