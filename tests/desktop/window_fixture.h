#pragma once
#include <QApplication>
#include <QComboBox>
#include <QFile>
#include <QFileDialog>
#include <QLineEdit>
#include <QMenuBar>
#include <QMouseEvent>
#include <QPointer>
#include <QProcess>
#include <QPushButton>
#include <QSettings>
#include <QTabBar>
#include <QTabWidget>
#include <QTemporaryDir>
#include <QTest>
#include <QThread>
#include <QToolButton>
#include <QTreeView>
#include <cmath>
#include <functional>
#include <memory>

#include "answers.h"
#include "plenoflame/base/error.h"
#include "plenoflame/image/light_field.h"
#include "widgets/controls/side_panel.h"
#include "widgets/image/image_panel.h"
#include "widgets/image/image_view.h"
#include "widgets/image/light_field_panel.h"
#include "widgets/panels/scene_panel.h"
#include "widgets/window/file_tasks.h"
#include "widgets/window/main_window.h"

namespace plenoflame::desktop::test {

/// Share of the pixels of two pictures that differ visibly.
inline double difference(const QImage& a, const QImage& b) {
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

/// A window with settings and recovery of its own.
class WindowFixture : public QObject {
 protected:
  std::unique_ptr<QTemporaryDir> folder_;
  std::unique_ptr<MainWindow> window_;
  Answers answers_;

  QWidget* dock(const char* name) { return window_->findChild<QWidget*>(name); }
  std::unique_ptr<QSettings> settings() const {
    return std::make_unique<QSettings>(folder_->filePath("settings.ini"), QSettings::IniFormat);
  }
  void make_window() {
    window_ = std::make_unique<MainWindow>(settings(), folder_->filePath("recovery").toStdString());
    window_->set_unattended(true);
    window_->resize(1400, 900);
    window_->show();
    QVERIFY(QTest::qWaitForWindowExposed(window_.get()));
    QApplication::setActiveWindow(window_.get());  // there is no window manager to do it
  }
  void begin() {
    folder_ = std::make_unique<QTemporaryDir>();
    make_window();
  }
  void end() {
    answers_.end();
    window_.reset();
  }
  bool settled() {
    return until([this] { return window_->is_settled(); });
  }
  /// Files that are read or written in the background are there.
  bool written() {
    return until([this] { return !window_->is_file_busy(); });
  }
  /// Asks for something to be read or written, and cancels it right after its beginning.
  void cancel_at_once(const std::function<void()>& ask) {
    auto* const files = window_->findChild<FileTasks*>();
    files->add(
        "before",
        [](const Execution& execution) {
          while (!execution.stop.stop_requested()) QThread::msleep(1);
          throw Cancelled();
        },
        [] {});
    ask();
    QObject here;
    QObject::connect(files, &FileTasks::cancelled, &here, [files](const QString& what) {
      if (what == "before") files->cancel();  // what waited has begun
    });
    files->cancel();
    QVERIFY(written());
    QVERIFY2(window_->last_message().contains("cancelled"), qPrintable(window_->last_message()));
  }
  /// Path of a file in the folder of the test.
  QString file(const QString& name) const { return folder_->filePath(name); }
  void write(const QString& path, const QByteArray& text) {
    QFile out(path);
    QVERIFY(out.open(QIODevice::WriteOnly));
    out.write(text);
  }
  /// Types a value into the tree.
  void type(const char* path, const QString& text) {
    ScenePanel& panel = window_->scene_panel();
    panel.reveal(path);
    QTest::keyClick(&panel.tree(), Qt::Key_F2);
    auto* editor = panel.tree().findChild<QLineEdit*>();
    QVERIFY(editor);
    editor->selectAll();
    QTest::keyClicks(editor, text);
    const QPointer<QLineEdit> open = editor;
    QTest::keyClick(editor, Qt::Key_Return);
    QVERIFY(until([&] { return !open; }));  // what was typed is taken, or refused
  }
  ImageView& image() {
    if (!window_->image_panel().isVisible()) show_tab(LightFieldPanel::Tab::raw);
    return window_->image_panel().view();
  }
  Session& session() { return window_->session(); }
  QPoint of_pixel(int column, int row) {
    return image().to_widget(QPointF(column + 0.5, row + 0.5)).toPoint();
  }
  template <class Widget>
  Widget* child(const char* name) {
    return window_->findChild<Widget*>(name);
  }
  /// Calls act(dialog) once a dialog of this class is on the screen.
  template <class Dialog>
  void when_shown(std::function<void(Dialog&)> act) {
    answers_.when_shown<Dialog>(std::move(act));
  }
  /// The output of a program; fails when the program does.
  QString run(const QString& program, const QStringList& arguments) {
    QProcess process;
    process.start(program, arguments);
    if (!process.waitForFinished(test::kPatience) || process.exitCode() != 0)
      qWarning("%s", process.readAllStandardError().constData());
    return QString::fromUtf8(process.readAllStandardOutput());
  }
  /// The first button or list of this panel's toolbar that is cut at this size of the window, or
  /// hidden without being one of `hidden`; empty: everything is seen.
  static QString cut_tool(MainWindow& window, QSize size, const QWidget& panel,
                          const QStringList& hidden = {}) {
    window.resize(size);
    if (!until([&] { return window.size() == size; })) return "the window";
    QTest::qWait(50);
    for (const QWidget* tool : panel.findChildren<QWidget*>()) {
      const auto* const button = qobject_cast<const QToolButton*>(tool);
      if (tool->window() != &window) continue;  // behind the last button of its row
      if (!button && !qobject_cast<const QComboBox*>(tool)) continue;
      const QString name = tool->objectName().startsWith("moreOf") ? tool->objectName()
                           : button && button->defaultAction()
                               ? button->defaultAction()->objectName() + " " + button->text()
                               : tool->objectName() + " " + tool->toolTip();
      if (tool->isHidden() && hidden.contains(name.section(' ', 0, 0))) continue;
      if (tool->isHidden() && name.startsWith("moreOf")) continue;  // there is nothing behind it
      const bool whole = tool->isVisible() &&
                         tool->visibleRegion().boundingRect() == tool->rect() &&
                         tool->width() >= tool->minimumSizeHint().width();
      if (!whole) return name;
    }
    return {};
  }
  /// Opens a group of the side panel by its title, where it is closed.
  void raise(const char* group) {
    auto* const title = child<QToolButton>(qPrintable(QString(group) + "Title"));
    QVERIFY(title);
    if (!title->isChecked()) QTest::mouseClick(title, Qt::LeftButton);
    QTest::qWait(50);
  }
  void show_tab(LightFieldPanel::Tab tab) {
    QTabBar& bar = *window_->light_field_panel().tabs().tabBar();
    QTest::mouseClick(&bar, Qt::LeftButton, {}, bar.tabRect(static_cast<int>(tab)).center());
  }
  /// Waits; a slow machine gets its time.
  static bool until(const std::function<bool()>& condition, int milliseconds = test::kPatience) {
    return test::until(condition, milliseconds);
  }
  /// A key for the window, whatever dialogs took the focus before.
  void press(Qt::Key key, Qt::KeyboardModifiers modifiers = {}) {
    QApplication::setActiveWindow(window_.get());
    QTest::keyClick(window_.get(), key, modifiers);
  }
  static void mouse(QWidget* widget, QEvent::Type type, QPointF at, Qt::MouseButton button,
                    Qt::KeyboardModifiers modifiers = {}) {
    // QTest's moves have no button held.
    const bool held = button != Qt::NoButton && type != QEvent::MouseButtonRelease;
    QMouseEvent event(type, at, widget->mapToGlobal(at.toPoint()),
                      type == QEvent::MouseMove ? Qt::NoButton : button,
                      held ? Qt::MouseButtons(button) : Qt::MouseButtons(), modifiers);
    QApplication::sendEvent(widget, &event);
  }
  static void drag(QWidget* widget, QPointF from, QPointF to,
                   Qt::KeyboardModifiers modifiers = {}) {
    mouse(widget, QEvent::MouseButtonPress, from, Qt::LeftButton, modifiers);
    for (const double t : {0.3, 0.7, 1.0})
      mouse(widget, QEvent::MouseMove, from + t * (to - from), Qt::LeftButton, modifiers);
    mouse(widget, QEvent::MouseButtonRelease, to, Qt::LeftButton, modifiers);
  }
  /// Clicks through the menus, e.g. {"File", "Export", "All views..."}. False: there is no such.
  bool click_menu(const QStringList& path) {
    QMenuBar* const bar = window_->menuBar();
    QAction* const title = entry_of(*bar, path.value(0));
    if (!title || !title->menu()) return complain("no menu " + path.value(0));
    QMenu* const menu = title->menu();
    return click_through(*menu, path.mid(1), [bar, title] {
      QTest::mouseClick(bar, Qt::LeftButton, {}, bar->actionGeometry(title).center());
    });
  }
  /// Types a name into the next file dialog, key by key, and Return.
  void answer_file_dialog(const QString& path) {
    when_shown<QFileDialog>([path](QFileDialog& dialog) { test::type_file_name(dialog, path); });
  }
};

}  // namespace plenoflame::desktop::test
