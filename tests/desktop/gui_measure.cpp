// Times of everything that somebody waits for; run by hand, see docs/developer/testing.md. Nothing
// here passes or fails.
#include <QVTKOpenGLNativeWidget.h>
#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>
#include <vtkCallbackCommand.h>
#include <vtkNew.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkRendererCollection.h>

#include <QAction>
#include <QApplication>
#include <QElapsedTimer>
#include <QFileDialog>
#include <QLineEdit>
#include <QMetaEnum>
#include <QPushButton>
#include <QSlider>
#include <QSpinBox>
#include <QTabWidget>
#include <QTemporaryDir>
#include <QTest>
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <string>

#include "answers.h"
#include "gui_tests.h"
#include "heartbeat.h"
#include "plenoflame/image/pixel_values.h"
#include "widgets/image/image_panel.h"
#include "widgets/image/image_view.h"
#include "widgets/image/light_field_panel.h"
#include "widgets/panels/reconstruct_panel.h"
#include "widgets/panels/scene_panel.h"
#include "widgets/scene/scene_view.h"
#include "widgets/window/film_dialog.h"
#include "widgets/window/main_window.h"

// The program has the same line, so that it frees pictures as fast.
template class std::vector<float, plenoflame::ZeroedAllocator<float>>;

namespace plenoflame::desktop::test {
namespace {

/// Time that the calling thread waited for processors that others had, on Linux.
double waited() {
  std::ifstream file("/proc/thread-self/schedstat");
  double ran = 0, waiting = 0;
  file >> ran >> waiting;
  return 1e-6 * waiting;
}

struct Memory {
  double resident = 0, heap = 0;  ///< [MB] in memory, and allocated and not freed

  static Memory now() {
    std::ifstream file("/proc/self/statm");
    double total = 0, pages = 0;
    file >> total >> pages;
    const struct mallinfo2 heap = mallinfo2();
    return {pages * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6,
            1e-6 * (static_cast<double>(heap.uordblks) + static_cast<double>(heap.hblkhd))};
  }
};

double seconds_of_process() {
  std::ifstream stat("/proc/self/stat"), uptime("/proc/uptime");
  std::string word;
  double start = 0, up = 0;
  for (int i = 1; i <= 22 && stat >> word; ++i)
    if (i == 22) start = std::stod(word);
  uptime >> up;
  return up - start / static_cast<double>(sysconf(_SC_CLK_TCK));
}

const char* name_of(QEvent::Type type) {
  const char* const name = QMetaEnum::fromType<QEvent::Type>().valueToKey(type);
  return name ? name : "event";
}

/// Turns the scene at rest as fast as it is drawn; the view has the screen.
void turn(MainWindow& window, Heartbeat& heart) {
  auto* const view = window.findChild<QWidget*>("scene3d");
  view->setFocus();
  QAction* const full = window.findChild<QAction*>("actionFull");
  full->trigger();
  QTest::qWait(1500);
  const QPoint middle = view->rect().center();
  heart.take();
  QTest::mousePress(view, Qt::LeftButton, {}, middle);
  QElapsedTimer since;
  since.start();
  const double worked_before = worked(), all_before = milliseconds(CLOCK_PROCESS_CPUTIME_ID);
  constexpr int kPictures = 60;
  int drawn = 0;
  vtkNew<vtkCallbackCommand> counter;
  counter->SetClientData(&drawn);
  counter->SetCallback(
      [](vtkObject*, unsigned long, void* count, void*) { ++*static_cast<int*>(count); });
  auto* const screen = dynamic_cast<QVTKOpenGLNativeWidget*>(view);
  vtkRenderer* const renderer = screen->renderWindow()->GetRenderers()->GetFirstRenderer();
  const unsigned long watch = renderer->AddObserver(vtkCommand::EndEvent, counter);
  for (int i = 1; i <= kPictures; ++i) {
    QTest::mouseMove(view, middle + QPoint(4 * i, i));
    while (drawn < i) QApplication::processEvents(QEventLoop::WaitForMoreEvents);
    QApplication::processEvents();  // and it is on the screen
  }
  renderer->RemoveObserver(watch);
  const double seconds = 1e-3 * static_cast<double>(since.elapsed());
  const double work = (worked() - worked_before) / kPictures;
  const double all = (milliseconds(CLOCK_PROCESS_CPUTIME_ID) - all_before) / kPictures;
  QTest::mouseRelease(view, Qt::LeftButton, {}, middle + QPoint(4 * kPictures, kPictures));
  std::printf(
      "turning, %d x %d pixels: %.1f pictures a second, %.0f ms of work for one, %.0f ms of all "
      "threads; %s\n",
      view->width(), view->height(), kPictures / seconds, work, all, heart.take().c_str());
  QTest::qWait(1500);
  std::printf("  then at rest: %s\n", heart.take().c_str());
  full->trigger();
  QTest::qWait(500);
}

/// Saves the scene and the light field.
void save(MainWindow& window, const QString& folder, Heartbeat& heart) {
  heart.take();
  window.session().document().save((folder + "/scene.toml").toStdString());
  std::printf("saving the scene: %s\n", heart.take().c_str());
  Answers answers;
  answers.when_shown<QFileDialog>([&](QFileDialog& dialog) {
    type_file_name(dialog, folder + "/raw.exr");
    heart.take();
  });
  for (QAction* action : window.findChildren<QAction*>())
    if (action->text().startsWith("Light field (.exr)")) action->trigger();
  QElapsedTimer since;
  since.start();
  until([&] { return !window.is_file_busy(); });
  std::printf("saving the light field: %.2f s, %s\n", 1e-3 * static_cast<double>(since.elapsed()),
              heart.take().c_str());
}

/// Reconstructs with the settings that the panel offers, and stops.
void reconstruct(MainWindow& window, Heartbeat& heart) {
  window.findChild<QAction*>("actionReconstruct")->trigger();
  QTest::qWait(500);
  heart.take();
  ReconstructJob& job = window.reconstruct_panel().job();
  window.findChild<QPushButton*>("reconstructStart")->click();
  const bool ended = until([&] { return job.state() != ReconstructJob::State::running; }, 30000);
  std::printf("reconstructing%s: %s\n", ended ? "" : " for 30 s", heart.take().c_str());
  if (ended) return;
  QElapsedTimer since;
  since.start();
  window.findChild<QPushButton*>("reconstructStop")->click();
  until([&] { return job.state() != ReconstructJob::State::running; });
  std::printf("  stopped after %.1f s, %s\n", 1e-3 * static_cast<double>(since.elapsed()),
              heart.take().c_str());
}

}  // namespace

bool TimedApplication::notify(QObject* receiver, QEvent* event) {
  if (depth_ > 0) return QApplication::notify(receiver, event);
  const QEvent::Type type = event->type();
  const std::string who =
      std::string(receiver->metaObject()->className()) + " " + receiver->objectName().toStdString();
  const double since = wall(), before = worked(), waited_before = waited();
  ++depth_;
  const bool done = QApplication::notify(receiver, event);
  --depth_;
  const double took = wall() - since, work = worked() - before;
  static const double least = qEnvironmentVariable("PLENOFLAME_REPORTED", "40").toDouble();  // [ms]
  if (std::max(took, work) > least)
    std::printf("    %.0f ms, %.0f ms of them work, %.0f ms waiting for a processor: %s of %s\n",
                took, work, waited() - waited_before, name_of(type), who.c_str());
  return done;
}

int measure(const char* scene) {
  QTemporaryDir folder;
  std::setvbuf(stdout, nullptr, _IOLBF, 0);  // into pipes, too
  Heartbeat heart;
  const auto reached = [&](const char* what) {
    std::printf("%5.2f s, work of the window %.2f s  %s\n", seconds_of_process(), 1e-3 * worked(),
                what);
  };
  reached("main() and Qt");
  auto made = std::make_unique<MainWindow>(
      std::make_unique<QSettings>(folder.filePath("settings.ini"), QSettings::IniFormat),
      std::string());
  MainWindow& window = *made;
  window.set_unattended(true);
  window.resize(1500, 900);
  reached("window made");
  window.appear();
  reached("on the screen");
  std::printf("    %s\n", heart.take().c_str());
  if (!window.open(scene)) return 1;
  reached("scene opened");
  Session& session = window.session();
  QElapsedTimer since;
  const auto until = [&](auto condition, int milliseconds = 200000) {
    return QTest::qWaitFor(condition, milliseconds);
  };
  until([&] { return session.compiler().compiled() != nullptr; });
  reached("scene prepared");
  until([&] { return session.document().image() != nullptr; });
  reached("first image");
  if (!until([&] { return window.image_panel().pyramid() != nullptr; })) return 1;
  reached("first picture on screen");
  std::printf("    %s\n", heart.take().c_str());
  since.start();
  if (!until([&] { return window.is_settled(); })) return 1;
  std::printf("until the picture is finished: %.2f s, %s\n",
              1e-3 * static_cast<double>(since.elapsed()), heart.take().c_str());
  const bool views = until([&] { return session.light_field().views() != nullptr; }, 20000);
  std::printf("%s: %s\n", views ? "views are there" : "no views yet, others have the processors",
              heart.take().c_str());
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
  std::printf("  %s\n", heart.take().c_str());
  window.light_field_panel().show_tab(LightFieldPanel::Tab::refocus);
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
  std::printf("  %s\n", heart.take().c_str());
  // The first picture after an edit, another theme, and a film are timed.
  for (const char* scale : {"0.9", "0.8", "0.85", "0.95", "1"}) {
    session.document().set_value("flames[0].scale", scale);
    since.restart();
    const auto before_edit = session.document().image();
    until([&] { return session.document().image() != before_edit; });
    std::printf("first picture after an edit: %lld ms\n", static_cast<long long>(since.elapsed()));
    if (!until([&] { return window.is_settled(); })) return 1;
    std::printf("  until it is finished: %lld ms, %s\n", static_cast<long long>(since.elapsed()),
                heart.take().c_str());
  }
  auto* const dark = window.findChild<QAction*>("actionDark");
  for (int i = 0; i < 4; ++i) {
    since.restart();
    dark->toggle();
    QApplication::processEvents();  // everything is painted
    std::printf("another theme: %lld ms\n", static_cast<long long>(since.elapsed()));
    QTest::qWait(300);
  }
  std::printf("  %s\n", heart.take().c_str());
  turn(window, heart);
  save(window, folder.path(), heart);
  reconstruct(window, heart);
  // Pan, zoom, turn, edit while it renders.
  session.document().set_value("render.samples", "4096");
  for (int i = 0; i < 40; ++i) {
    QTest::keyClick(&view, i % 2 == 0 ? Qt::Key_Plus : Qt::Key_Minus);
    QTest::qWait(25);
  }
  std::printf("zooming while it renders: %s\n", heart.take().c_str());
  QWidget* const scene3d = window.findChild<QWidget*>("scene3d");
  QTest::mousePress(scene3d, Qt::LeftButton, {}, scene3d->rect().center());
  for (int i = 0; i < 30; ++i) {
    QTest::mouseMove(scene3d, scene3d->rect().center() + QPoint(4 * i, i));
    QTest::qWait(25);
  }
  QTest::mouseRelease(scene3d, Qt::LeftButton, {}, scene3d->rect().center() + QPoint(120, 30));
  std::printf("turning the scene while it renders: %s\n", heart.take().c_str());
  for (int i = 0; i < 20; ++i) {
    session.document().set_value("camera.focus.object_distance", std::to_string(1001 + i) + " mm");
    QTest::qWait(60);
  }
  std::printf("editing while it renders: %s\n", heart.take().c_str());
  session.document().set_value("render.samples", "2");
  window.scene_panel().reveal("flames[0].scale");
  window.findChild<QAction*>("actionFilm")->trigger();
  auto* const film = window.findChild<FilmDialog*>();
  window.findChild<QLineEdit*>("filmTo")->setText("0.5");
  window.findChild<QSpinBox*>("filmFrames")->setValue(50);
  since.restart();
  film->record(folder.filePath("film.png"));
  const double worked_before = milliseconds(CLOCK_PROCESS_CPUTIME_ID);
  until([&] { return !film->is_recording(); }, 600000);
  std::printf("film of 50 steps: %.1f s, of it %.1f s of a processor; %s; %s\n",
              1e-3 * static_cast<double>(since.elapsed()),
              1e-3 * (milliseconds(CLOCK_PROCESS_CPUTIME_ID) - worked_before),
              qPrintable(film->message()), heart.take().c_str());
  film->close();
  // A leak would show after the history is full.
  const int edits = qEnvironmentVariableIntValue("PLENOFLAME_EDITS");
  constexpr int kFirst = 500;
  const auto print = [&](int done) {
    until([&] { return window.is_settled(); });
    QTest::qWait(1000);  // what the last picture replaced is freed
    const Memory memory = Memory::now();
    std::printf("after %d edits: heap %.2f MB, resident %.1f MB\n", done, memory.heap,
                memory.resident);
  };
  for (int i = 0; i < kFirst + edits && edits > 0; ++i) {
    if (i >= kFirst && (i - kFirst) % 500 == 0) print(i);
    session.document().set_value(
        i % 2 == 0 ? "camera.focus.object_distance" : "flames[0].scale",
        i % 2 == 0 ? std::to_string(1000 + i % 97) + " mm" : std::to_string(1 + 0.001 * (i % 89)));
    QTest::qWait(5);
  }
  if (edits > 0) print(kFirst + edits);
  session.document().set_value("render.samples", "4096");
  QTest::qWait(1000);
  heart.take();
  since.start();
  made.reset();
  std::printf("quitting while it renders: %lld ms\n", static_cast<long long>(since.elapsed()));
  return 0;
}

}  // namespace plenoflame::desktop::test
