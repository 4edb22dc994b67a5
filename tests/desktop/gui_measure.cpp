// How long things take that somebody waits for; run by hand, see docs/benchmarks.md. Nothing here
// passes or fails.
#include <sys/resource.h>

#include <unistd.h>
#include <QApplication>
#include <QElapsedTimer>
#include <QSlider>
#include <QTabWidget>
#include <QTemporaryDir>
#include <QTest>
#include <QTimer>
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <string>

#include "gui_tests.h"
#include "widgets/image_panel.h"
#include "widgets/image_view.h"
#include "widgets/light_field_panel.h"
#include "widgets/main_window.h"
#include "widgets/scene_view.h"

namespace plenoflame::desktop::test {
namespace {

/// The longest time that the event loop did not turn.
class Heartbeat : public QObject {
 public:
  Heartbeat() {
    connect(&timer_, &QTimer::timeout, this, [this] {
      longest_ = std::max(longest_, static_cast<double>(since_.nsecsElapsed()) * 1e-6);
      since_.restart();
    });
    timer_.setTimerType(Qt::PreciseTimer);
    timer_.start(1);
    since_.start();
  }
  /// [ms] since the last call
  double take() {
    longest_ = std::max(longest_, static_cast<double>(since_.nsecsElapsed()) * 1e-6);
    since_.restart();
    return std::exchange(longest_, 0);
  }

 private:
  QTimer timer_;
  QElapsedTimer since_;
  double longest_ = 0;
};

double resident() {
  std::ifstream file("/proc/self/statm");
  double total = 0, pages = 0;
  file >> total >> pages;
  return pages * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

double seconds_of_process() {
  std::ifstream stat("/proc/self/stat"), uptime("/proc/uptime");
  std::string word;
  double start = 0, up = 0;
  for (int i = 1; i <= 22 && stat >> word; ++i)
    if (i == 22) start = std::stod(word);
  uptime >> up;
  return up - start / static_cast<double>(sysconf(_SC_CLK_TCK));
}

}  // namespace

int measure(const char* scene) {
  QTemporaryDir folder;
  MainWindow window(
      std::make_unique<QSettings>(folder.filePath("settings.ini"), QSettings::IniFormat), {});
  window.set_unattended(true);
  window.resize(1500, 900);
  Heartbeat heart;
  window.show();
  if (!QTest::qWaitForWindowExposed(&window)) return 1;
  QTest::qWait(300);
  std::printf("welcome page: longest pause of the window %.0f ms\n", heart.take());
  QElapsedTimer since;
  const auto until = [&](auto condition, int milliseconds = 200000) {
    return QTest::qWaitFor(condition, milliseconds);
  };
  const double opened = seconds_of_process();
  if (!window.open(scene)) return 1;
  Session& session = window.session();
  if (!until([&] { return window.image_panel().pyramid() != nullptr; })) return 1;
  std::printf("process start to scene opened %.2f s, to first picture %.2f s\n", opened,
              seconds_of_process());
  std::printf("  longest pause until then %.0f ms\n", heart.take());
  since.start();
  if (!until([&] { return window.is_settled(); })) return 1;
  std::printf("until the picture is finished: %.2f s, longest pause %.0f ms\n",
              1e-3 * static_cast<double>(since.elapsed()), heart.take());
  until([&] { return session.light_field().views() != nullptr; });
  std::printf("views are there: longest pause %.0f ms\n", heart.take());
  ImageView& view = window.image_panel().view();
  for (int i = 0; i < 5; ++i) {
    const QPoint at = view.rect().center() + QPoint(9 * i, 5 * i);
    const auto before = session.rays().rays();
    since.restart();
    QTest::mouseClick(&view, Qt::LeftButton, {}, at);
    until([&] { return session.rays().rays() && session.rays().rays() != before; });
    const auto ready = since.elapsed();
    window.scene_view().picture();
    std::printf("rays of a clicked pixel: computed %lld ms, drawn %lld ms\n",
                static_cast<long long>(ready), static_cast<long long>(since.elapsed()));
    QTest::qWait(300);
  }
  std::printf("  longest pause %.0f ms\n", heart.take());
  window.light_field_panel().tabs().setCurrentIndex(1);
  auto* slider = window.findChild<QSlider*>("depthSlider");
  const auto shown = [&](bool exact) {
    const DerivedImage& r = session.light_field().refocused();
    return r.image && r.depth == window.light_field_panel().depth() && (!exact || !r.preview);
  };
  until([&] { return shown(true); });
  for (int i = 0; i < 5; ++i) {
    since.restart();
    QTest::keyClick(slider, Qt::Key_PageUp);
    until([&] { return shown(false); });
    const auto quick = since.elapsed();
    until([&] { return shown(true); });
    std::printf("refocused: quick picture %lld ms, exact one %lld ms\n",
                static_cast<long long>(quick), static_cast<long long>(since.elapsed()));
  }
  std::printf("  longest pause %.0f ms\n", heart.take());
  // Pan, zoom, turn, edit while it renders.
  session.document().set_value("render.samples", "4096");
  for (int i = 0; i < 40; ++i) {
    QTest::keyClick(&view, i % 2 == 0 ? Qt::Key_Plus : Qt::Key_Minus);
    QTest::qWait(25);
  }
  std::printf("zooming while it renders: longest pause %.0f ms\n", heart.take());
  QWidget* const scene3d = window.findChild<QWidget*>("scene3d");
  QTest::mousePress(scene3d, Qt::LeftButton, {}, scene3d->rect().center());
  for (int i = 0; i < 30; ++i) {
    QTest::mouseMove(scene3d, scene3d->rect().center() + QPoint(4 * i, i));
    QTest::qWait(25);
  }
  QTest::mouseRelease(scene3d, Qt::LeftButton, {}, scene3d->rect().center() + QPoint(120, 30));
  std::printf("turning the scene while it renders: longest pause %.0f ms\n", heart.take());
  for (int i = 0; i < 20; ++i) {
    session.document().set_value("camera.focus.object_distance", std::to_string(1001 + i) + " mm");
    QTest::qWait(60);
  }
  std::printf("editing while it renders: longest pause %.0f ms\n", heart.take());
  // A leak would show after the history is full.
  session.document().set_value("render.samples", "2");
  const int edits = qEnvironmentVariableIntValue("PLENOFLAME_EDITS");
  double full = 0;
  for (int i = 0; i < 500 + edits && edits > 0; ++i) {
    if (i == 500) full = resident();
    session.document().set_value(
        i % 2 == 0 ? "camera.focus.object_distance" : "flames[0].scale",
        i % 2 == 0 ? std::to_string(1000 + i % 97) + " mm" : std::to_string(1 + 0.001 * (i % 89)));
    QTest::qWait(5);
  }
  if (edits > 0) {
    until([&] { return window.is_settled(); });
    std::printf("%d edits after the first 500: resident memory %.1f MB -> %.1f MB\n", edits, full,
                resident());
  }
  return 0;
}

}  // namespace plenoflame::desktop::test
