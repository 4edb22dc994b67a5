// Menus and dialogs that a test opens: what is clicked in them, and that none stays.
#pragma once
#include <QApplication>
#include <QDialog>
#include <QElapsedTimer>
#include <QFileDialog>
#include <QMenu>
#include <QPointer>
#include <QStringList>
#include <QTest>
#include <QTimer>
#include <algorithm>
#include <functional>
#include <memory>
#include <vector>

namespace plenoflame::desktop::test {

/// The test function fails, with this text; it goes on, so that what is open gets closed.
inline bool complain(const QString& text) {
  QTest::qFail(qPrintable(text), __FILE__, __LINE__);
  return false;
}

/// [ms] that a machine gets which is slow, and busy with other things as well.
constexpr int kPatience = 300000;

/// Waits; a slow machine gets its time.
inline bool until(const std::function<bool()>& condition, int milliseconds = kPatience) {
  return QTest::qWaitFor(condition, milliseconds);
}

inline void close_popups() {
  for (int i = 0; i < 20 && QApplication::activePopupWidget(); ++i)
    QApplication::activePopupWidget()->close();
}

/// The title and texts of a widget, for a message.
QString words_of(const QWidget& widget);

/// Answers menus and dialogs. Each of them runs an event loop of its own, which ends when somebody
/// closes it and not before: what nobody answers, or an answer did not close, is closed here after
/// a while, and the test function fails.
class Answers : public QObject {
 public:
  static constexpr int kLongest = 120000;  ///< [ms] that a menu or dialog may stay in front

  Answers() { watch(); }

  /// Calls act(widget) once a widget of this class is on the screen.
  template <class Widget>
  void when_shown(std::function<void(Widget&)> act) {
    auto awaited = std::make_shared<Awaited>();
    awaited->name = Widget::staticMetaObject.className();
    awaited->answer = [act = std::move(act), state = std::weak_ptr<Awaited>(awaited)] {
      for (QWidget* widget : QApplication::topLevelWidgets())
        if (auto* wanted = qobject_cast<Widget*>(widget); wanted && wanted->isVisible()) {
          state.lock()->done = true;  // it may open others of its kind
          act(*wanted);
          return;
        }
    };
    awaited_.push_back(awaited);
    look_for(awaited);
  }

  /// Forgets what never came. False: there was something.
  bool end() {
    QStringList missing;
    for (const auto& awaited : awaited_) {
      if (!awaited->done) missing << awaited->name;
      awaited->done = true;
    }
    awaited_.clear();
    close_popups();
    return missing.isEmpty() || complain("never shown: " + missing.join(", "));
  }

 private:
  struct Awaited {
    QString name;
    std::function<void()> answer;
    bool done = false;
  };
  static constexpr int kInterval = 50;  ///< [ms]

  // Single shots: a timer that repeats would not fire in the event loops that its own slot enters.
  void look_for(const std::shared_ptr<Awaited>& awaited) {
    QTimer::singleShot(kInterval, this, [this, awaited] {
      if (!awaited->done) awaited->answer();
      if (!awaited->done) look_for(awaited);
    });
  }
  void watch() {
    QTimer::singleShot(5 * kInterval, this, [this] {
      watch();
      QWidget* const popup = QApplication::activePopupWidget();
      QWidget* const front = popup ? popup : QApplication::activeModalWidget();
      if (front != front_ || !front) {
        front_ = front;
        since_.start();
        return;
      }
      if (since_.elapsed() < kLongest) return;
      complain("stayed open: " + words_of(*front));
      since_.start();
      if (popup)
        close_popups();
      else if (auto* dialog = qobject_cast<QDialog*>(front))
        dialog->reject();
      else
        front->close();
    });
  }

  std::vector<std::shared_ptr<Awaited>> awaited_;
  QPointer<QWidget> front_;
  QElapsedTimer since_;
};

/// Clicks through menus, the first of which is open: all but the last text name submenus. Each
/// click waits until its menu is on the screen, and is repeated when it did not take: the pointer
/// of the screen opens and closes menus, too. False, with a message and every menu closed: no such
/// entry.
/// @param open_first opens the first menu, again where all were closed on the way; empty: it is
/// open
bool click_through(QMenu& first, const QStringList& texts,
                   const std::function<void()>& open_first = {});
/// The entry of a menu or menu bar with this text; null: there is none.
QAction* entry_of(const QWidget& menu, const QString& text);

/// Types a name into a file dialog, key by key instead of what it suggests, and Return. False, with
/// a message: it stayed open.
bool type_file_name(QFileDialog& dialog, const QString& path);

}  // namespace plenoflame::desktop::test
