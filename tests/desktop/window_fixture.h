#pragma once
#include <QApplication>
#include <QFileDialog>
#include <QLineEdit>
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
  void when_shown(std::function<void(Dialog&)> act, int tries = 100) {
    QTimer::singleShot(60, this, [this, act, tries] {
      for (QWidget* widget : QApplication::topLevelWidgets())
        if (auto* dialog = qobject_cast<Dialog*>(widget); dialog && dialog->isVisible())
          return act(*dialog);
      if (tries > 0) when_shown<Dialog>(act, tries - 1);
    });
  }
  /// Types a name into the next file dialog.
  void answer_file_dialog(const QString& path) {
    when_shown<QFileDialog>([path](QFileDialog& dialog) {
      auto* edit = dialog.findChild<QLineEdit*>("fileNameEdit");
      edit->setText(path);
      QTest::keyClick(edit, Qt::Key_Return);
    });
  }
};

}  // namespace plenoflame::desktop::test
