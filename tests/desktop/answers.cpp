#include "answers.h"

#include <QAction>
#include <QLabel>
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

bool click_through(QMenu& first, const QStringList& texts) {
  QPointer<QMenu> menu = &first;
  const auto give_up = [&](const QString& text) {
    const QString where = menu ? words_of(*menu) : QString();
    close_popups();
    return complain(text + " (" + texts.join(" > ") + "); " + where);
  };
  const auto is_open = [](const QPointer<QMenu>& m) { return m && m->isVisible(); };
  for (const QString& text : texts) {
    if (!until([&] { return is_open(menu); }, kTries * kWait)) return give_up("not open: " + text);
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
  }
  close_popups();
  return true;
}

}  // namespace plenoflame::desktop::test
