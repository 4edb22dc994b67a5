#pragma once
#include <QApplication>
#include <memory>

/// The tests of the window, each class in a file of its own; gui_main.cpp runs them by name.
namespace plenoflame::desktop::test {

std::unique_ptr<QObject> make_window_test();
std::unique_ptr<QObject> make_panels_test();
std::unique_ptr<QObject> make_selection_test();
std::unique_ptr<QObject> make_picture_test();
std::unique_ptr<QObject> make_files_test();
std::unique_ptr<QObject> make_exports_test();
std::unique_ptr<QObject> make_manners_test();
std::unique_ptr<QObject> make_tour_test();
std::unique_ptr<QObject> make_views_test();
std::unique_ptr<QObject> make_work_test();
std::unique_ptr<QObject> make_moments_test();
std::unique_ptr<QObject> make_handling_test();
std::unique_ptr<QObject> make_looks_test();
std::unique_ptr<QObject> make_reconstruct_test();
std::unique_ptr<QObject> make_lecture_test();
std::unique_ptr<QObject> make_drawing_test();
std::unique_ptr<QObject> make_surroundings_test();
std::unique_ptr<QObject> make_measured_test();
std::unique_ptr<QObject> make_object_test();

/// Opens a scene, changes it and, once it is kept aside, ends as a crash does.
/// @return never 0
int crash_with_changes(const char* scene, const char* recovery_folder);
/// Tells which events hold the window up: for measure().
class TimedApplication : public QApplication {
 public:
  using QApplication::QApplication;
  bool notify(QObject* receiver, QEvent* event) override;

 private:
  int depth_ = 0;
};
/// Prints how long things take that somebody waits for. @return exit status
int measure(const char* scene);
/// Prints for whatever can be done how long the window does not answer. @return exit status
int survey(const char* scene);

}  // namespace plenoflame::desktop::test
