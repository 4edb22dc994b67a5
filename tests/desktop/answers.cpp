#include "answers.h"

#include <QAction>
#include <QFileInfo>
#include <QLabel>
#include <QLineEdit>
#include <QMessageBox>

namespace plenoflame::desktop::test {
namespace {

constexpr int kTries = 10, kWait = 1000;  ///< [ms] for a click to take

}  // namespace

QString words_of(const QWidget& widget) {
  QStringList words{widget.metaObject()->className(), widget.windowTitle()};
  for (const QLabel* label : widget.findChildren<QLabel*>())
    if (label->isVisible()) words << label->text();
  for (const QAction* action : widget.actions()) words << action->text();
  words.removeAll({});
  return words.join(" | ");
}

QAction* entry_of(const QWidget& menu, const QString& text) {
  for (QAction* action : menu.actions())
    if (action->text().remove('&') == text) return action;
  return nullptr;
}

bool click_through(QMenu& first, const QStringList& texts,
                   const std::function<void()>& open_first) {
  QPointer<QMenu> menu = &first;
  const auto give_up = [&](const QString& text) {
    const QString where = menu ? words_of(*menu) : QString();
    close_popups();
    return complain(text + " (" + texts.join(" > ") + "); " + where);
  };
  const auto is_open = [](const QPointer<QMenu>& m) { return m && m->isVisible(); };
  int level = 0, openings = 0;
  if (open_first && !is_open(menu)) open_first();
  while (level < texts.size()) {
    const QString& text = texts[level];
    if (!until([&] { return is_open(menu); }, open_first ? kWait : kTries * kWait)) {
      if (!open_first || ++openings > kTries) return give_up("not open: " + text);
      close_popups();
      open_first();
      menu = &first;
      level = 0;
      continue;
    }
    const QPointer<QAction> action = entry_of(*menu, text);
    if (!action || !action->isEnabled()) return give_up("nothing to click: " + text);
    const auto click = [&] {
      QTest::mouseClick(menu, Qt::LeftButton, {}, menu->actionGeometry(action).center());
    };
    if (const QPointer<QMenu> next = action->menu()) {
      for (int i = 0; i < kTries && !is_open(next) && is_open(menu); ++i) {
        click();
        until([&] { return is_open(next); }, kWait);
      }
      menu = next;
      ++level;
      continue;
    }
    // Gone, as well as triggered: lists of files are made anew by what they open.
    bool triggered = false;
    const auto watched =
        QObject::connect(action, &QAction::triggered, menu, [&triggered] { triggered = true; });
    const auto taken = [&] { return triggered || !action; };
    for (int i = 0; i < kTries && !taken() && is_open(menu); ++i) {
      click();
      if (!taken()) until(taken, kWait / 5);
    }
    QObject::disconnect(watched);
    if (!taken()) return give_up("did not take: " + text);
    ++level;
  }
  close_popups();
  return true;
}

bool type_file_name(QFileDialog& dialog, const QString& path) {
  const QPointer<QFileDialog> open = &dialog;
  const QPointer<QLineEdit> edit = dialog.findChild<QLineEdit*>("fileNameEdit");
  // Without the focus the dialog would keep what it had found for the first letters. Nobody else
  // gives it where there is no window manager.
  const auto ready = [&] {
    QApplication::setActiveWindow(open);
    edit->setFocus();
    return edit->hasFocus();
  };
  const auto chosen = [&] {
    return QFileInfo(open->selectedFiles().value(0)) == QFileInfo(path) && edit->text() == path;
  };
  for (int i = 0; i < kTries && open && open->isVisible(); ++i) {
    if (!until(ready, kWait)) continue;
    QTest::keyClick(edit, Qt::Key_A, Qt::ControlModifier);
    QTest::keyClicks(edit, path);
    // Names that begin alike are offered below; what was typed is what is meant.
    close_popups();
    if (!until(chosen, kWait)) continue;
    QTest::keyClick(edit, Qt::Key_Return);
    until([&] { return !open || !open->isVisible(); }, kWait);
  }
  if (!open || !open->isVisible()) return true;
  const QString last = edit->text() + ", " + open->selectedFiles().join(' ');
  open->reject();
  return complain("did not take " + path + ": " + last);
}

}  // namespace plenoflame::desktop::test
