// A new user, from the welcome page to an exported ray bundle of a pixel and a refocused flame, by
// clicks alone: what is clicked is found by the words on it. With PLENOFLAME_TOUR set to a folder a
// picture of every step is kept there.
#include <QAbstractButton>
#include <QCommandLinkButton>
#include <QFile>
#include <QSlider>
#include <QTabBar>
#include <QTabWidget>

#include "gui_tests.h"
#include "plenoflame/base/error.h"
#include "widgets/image/light_field_panel.h"
#include "widgets/scene/scene_view.h"
#include "window_fixture.h"

using namespace plenoflame;
using namespace plenoflame::desktop;

class TourTest : public test::WindowFixture {
  Q_OBJECT

  int step_ = 0;
  void keep_picture(const char* name) {
    const QString folder = qEnvironmentVariable("PLENOFLAME_TOUR");
    if (folder.isEmpty()) return;
    QTest::qWait(150);
    window_->save_screenshot(QString("%1/%2-%3.png").arg(folder).arg(++step_).arg(name));
  }
  QAbstractButton* button(const QString& text) {
    for (auto* b : window_->findChildren<QAbstractButton*>())
      if (b->isVisible() && b->text().remove('&') == text) return b;
    return nullptr;
  }
  /// Clicks on a tab with these words, wherever it stands.
  bool click_tab(const QString& text) {
    for (auto* bar : window_->findChildren<QTabBar*>())
      for (int i = 0; bar->isVisible() && i < bar->count(); ++i)
        if (bar->tabText(i).remove('&') == text) {
          QTest::mouseClick(bar, Qt::LeftButton, {}, bar->tabRect(i).center());
          return true;
        }
    return false;
  }

 private slots:
  void fromTheWelcomePageToARefocusedFlame() {
    folder_ = std::make_unique<QTemporaryDir>();
    window_ = std::make_unique<MainWindow>(settings(), folder_->filePath("recovery").toStdString());
    window_->resize(1500, 900);
    window_->show();
    QVERIFY(QTest::qWaitForWindowExposed(window_.get()));
    QApplication::setActiveWindow(window_.get());
    keep_picture("welcome");
    const QString camera = qEnvironmentVariable("PLENOFLAME_TOUR_SCENE", "An unfocused camera");
    auto* start = button(camera);
    QVERIFY(start);
    QTest::mouseClick(start, Qt::LeftButton);
    QVERIFY(until([this] { return window_->is_settled(); }));
    QVERIFY(until([&] { return window_->scene_view().flame_temperatures()[1] > 0; }));
    keep_picture("scene");
    // A bright pixel of the picture.
    const LightField& field = *session().document().image();
    Pixel brightest{0, 0};
    for (int row = 0; row < field.sensor_height; ++row)
      for (int column = 0; column < field.sensor_width; ++column)
        if (field.channels[0].flux.at(column, row) >
            field.channels[0].flux.at(brightest.column, brightest.row))
          brightest = {column, row};
    QTest::mouseClick(&image(), Qt::LeftButton, {}, of_pixel(brightest.column, brightest.row));
    QVERIFY(until([this] { return session().rays().rays() != nullptr; }));
    keep_picture("rays");
    auto* rays = button("Export rays...");
    QVERIFY(rays && rays->isEnabled());
    answer_file_dialog(folder_->filePath("bundle"));  // no ending: the suggested one
    QTest::mouseClick(rays, Qt::LeftButton);
    QVERIFY(written());
    QVERIFY(QFile::exists(folder_->filePath("bundle.vtp")));
    QVERIFY(run(PLENOFLAME_COMMAND, {"info", folder_->filePath("bundle.vtp")}).contains("32"));
    keep_picture("exported");
    QVERIFY(click_tab("Refocus"));
    const auto exact = [this] {
      const DerivedImage& r = session().light_field().refocused();
      return r.image && !r.preview && r.depth == window_->light_field_panel().depth();
    };
    QVERIFY(until(exact));
    keep_picture("refocused");
    auto* depth = child<QSlider>("depthSlider");
    const double before = window_->light_field_panel().depth();
    for (int i = 0; i < 4; ++i)
      QTest::mouseClick(depth, Qt::LeftButton, {}, QPoint(depth->width() - 4, depth->height() / 2));
    QVERIFY(window_->light_field_panel().depth() > before);
    QVERIFY(until(exact));
    auto* save = child<QToolButton>("exportDerived");
    QVERIFY(save);
    answer_file_dialog(folder_->filePath("refocused"));
    QTest::mouseClick(save, Qt::LeftButton);
    QVERIFY(written());
    QVERIFY(QFile::exists(folder_->filePath("refocused.png")));
    keep_picture("end");
    window_.reset();
  }
};

std::unique_ptr<QObject> plenoflame::desktop::test::make_tour_test() {
  return std::make_unique<TourTest>();
}

#include "tour_test.moc"
