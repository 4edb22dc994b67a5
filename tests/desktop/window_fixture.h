#pragma once
#include <QApplication>
#include <QDockWidget>
#include <QFileDialog>
#include <QLineEdit>
#include <QMenu>
#include <QMenuBar>
#include <QMouseEvent>
#include <QProcess>
#include <QPushButton>
#include <QSettings>
#include <QTemporaryDir>
#include <QTest>
#include <QTimer>
#include <cmath>
#include <functional>
#include <memory>

#include "plenoflame/image/light_field.h"
#include "widgets/image_panel.h"
#include "widgets/image_view.h"
#include "widgets/main_window.h"

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

  QWidget* dock(const char* name) { return window_->findChild<QWidget*>(name); }
  std::unique_ptr<QSettings> settings() const {
    return std::make_unique<QSettings>(folder_->filePath("settings.ini"), QSettings::IniFormat);
  }
  void make_window() {
    window_ = std::make_unique<MainWindow>(settings(), folder_->filePath("recovery").toStdString());
    window_->set_unattended(true);
    dock("lightFieldDock")->hide();  // views cost time: shown where they are wanted
    window_->resize(1400, 900);
    window_->show();
    QVERIFY(QTest::qWaitForWindowExposed(window_.get()));
    QApplication::setActiveWindow(window_.get());  // there is no window manager to do it
  }
  void begin() {
    folder_ = std::make_unique<QTemporaryDir>();
    make_window();
  }
  bool settled() {
    return QTest::qWaitFor([this] { return window_->is_settled(); }, 60000);
  }
  ImageView& image() { return window_->image_panel().view(); }
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
  void when_shown(std::function<void(Dialog&)> act, int tries = 500) {
    QTimer::singleShot(60, this, [this, act, tries] {
      for (QWidget* widget : QApplication::topLevelWidgets())
        if (auto* dialog = qobject_cast<Dialog*>(widget); dialog && dialog->isVisible())
          return act(*dialog);
      if (tries > 0) when_shown<Dialog>(act, tries - 1);
    });
  }
  /// What a program prints; fails when it does.
  QString run(const QString& program, const QStringList& arguments) {
    QProcess process;
    process.start(program, arguments);
    if (!process.waitForFinished(120000) || process.exitCode() != 0)
      qWarning("%s", process.readAllStandardError().constData());
    return QString::fromUtf8(process.readAllStandardOutput());
  }
  void raise(const char* dock) {
    auto* widget = child<QDockWidget>(dock);
    widget->show();
    widget->raise();
    QTest::qWait(50);
  }
  /// Waits; a slow machine gets its time.
  static bool until(const std::function<bool()>& condition, int milliseconds = 60000) {
    return QTest::qWaitFor(condition, milliseconds);
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
    const auto action_of = [](QWidget& menu, const QString& text) -> QAction* {
      for (QAction* action : menu.actions())
        if (action->text().remove('&') == text) return action;
      return nullptr;
    };
    QMenuBar* const bar = window_->menuBar();
    QAction* action = action_of(*bar, path.value(0));
    if (!action) return false;
    QTest::mouseClick(bar, Qt::LeftButton, {}, bar->actionGeometry(action).center());
    QMenu* parent = nullptr;
    for (int i = 1; i < path.size(); ++i) {
      QMenu* const menu = action->menu();
      if (!menu) return false;
      // A submenu that the pointer had opened already is closed by a click: then once more.
      for (int tries = 0; tries < 10 && !menu->isVisible(); ++tries) {
        if (QTest::qWaitFor([menu] { return menu->isVisible(); }, 1000)) break;
        if (parent)
          QTest::mouseClick(parent, Qt::LeftButton, {}, parent->actionGeometry(action).center());
      }
      if (!menu->isVisible()) return false;
      parent = menu;
      action = action_of(*menu, path[i]);
      if (!action) return false;
      QTest::mouseClick(menu, Qt::LeftButton, {}, menu->actionGeometry(action).center());
    }
    return true;
  }
  /// Types a name into the next file dialog.
  void answer_file_dialog(const QString& path) {
    when_shown<QFileDialog>([path](QFileDialog& dialog) {
      auto* edit = dialog.findChild<QLineEdit*>("fileNameEdit");
      edit->setText(path);
      QTest::qWait(30);
      QTest::keyClick(edit, Qt::Key_Return);
    });
  }
};

}  // namespace plenoflame::desktop::test
