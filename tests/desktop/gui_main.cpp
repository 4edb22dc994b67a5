// Tests of the window:  desktop_gui_test NAME [QtTest's options]
//                       desktop_gui_test crash SCENE.toml FOLDER
//                       desktop_gui_test measure SCENE.toml
//                       desktop_gui_test survey SCENE.toml
#include <QVTKOpenGLNativeWidget.h>
#include <QApplication>
#include <QStringList>
#include <QSurfaceFormat>
#include <QTest>
#include <array>
#include <cstdio>
#include <memory>
#include <string>

#include "gui_tests.h"

namespace {

using namespace plenoflame::desktop::test;

struct Entry {
  const char* name;
  std::unique_ptr<QObject> (*make)();
};
constexpr std::array<Entry, 19> kTests{{{"window", make_window_test},
                                        {"panels", make_panels_test},
                                        {"selection", make_selection_test},
                                        {"picture", make_picture_test},
                                        {"files", make_files_test},
                                        {"exports", make_exports_test},
                                        {"manners", make_manners_test},
                                        {"tour", make_tour_test},
                                        {"views", make_views_test},
                                        {"work", make_work_test},
                                        {"moments", make_moments_test},
                                        {"handling", make_handling_test},
                                        {"looks", make_looks_test},
                                        {"reconstruct", make_reconstruct_test},
                                        {"lecture", make_lecture_test},
                                        {"drawing", make_drawing_test},
                                        {"surroundings", make_surroundings_test},
                                        {"measured", make_measured_test},
                                        {"object", make_object_test}}};

}  // namespace

int main(int argc, char** argv) {
  QSurfaceFormat::setDefaultFormat(QVTKOpenGLNativeWidget::defaultFormat());
#if QT_VERSION < QT_VERSION_CHECK(6, 0, 0)
  QApplication::setAttribute(Qt::AA_EnableHighDpiScaling);
  QApplication::setAttribute(Qt::AA_UseHighDpiPixmaps);
#endif
  QApplication::setAttribute(Qt::AA_DontUseNativeDialogs);
  const std::string mode = argc == 3 ? argv[1] : "";
  const bool measured = mode == "measure" || mode == "survey";
  const std::unique_ptr<QApplication> application =
      measured ? std::make_unique<TimedApplication>(argc, argv)
               : std::make_unique<QApplication>(argc, argv);
  QStringList arguments = QApplication::arguments();
  const QString name = arguments.value(1);
  if (name == "crash" && argc == 4) return crash_with_changes(argv[2], argv[3]);
  if (measured) return mode == "measure" ? measure(argv[2]) : survey(argv[2]);
  for (const Entry& entry : kTests) {
    if (name != entry.name) continue;
    arguments.removeAt(1);
    return QTest::qExec(entry.make().get(), arguments);
  }
  std::fprintf(stderr, "usage: desktop_gui_test NAME [QtTest's options]; names:");
  for (const Entry& entry : kTests) std::fprintf(stderr, " %s", entry.name);
  std::fprintf(stderr, "\n");
  return 2;
}
