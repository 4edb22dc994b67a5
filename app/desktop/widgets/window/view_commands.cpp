#include "widgets/window/view_commands.h"

#include <QAction>
#include <QApplication>
#include <QClipboard>
#include <QDockWidget>
#include <QEvent>
#include <QMainWindow>
#include <QMenu>
#include <QStatusBar>

#include "widgets/scene/scene_view.h"

namespace plenoflame::desktop {

ViewCommands::ViewCommands(QMainWindow& window, SceneView& scene,
                           const std::array<QWidget*, 3>& views, QMenu& view, QMenu& edit)
    : QObject(&window), window_(window), scene_(scene), views_(views), first_(window.saveState()) {
  full_ = view.addAction(tr("Full size"));
  full_->setObjectName("actionFull");
  full_->setCheckable(true);
  full_->setShortcut(Qt::Key_F11);
  full_->setToolTip(tr("The view under the pointer, or the one that has the focus, alone"));
  connect(full_, &QAction::toggled, this, &ViewCommands::set_full);
  connect(view.addAction(tr("Reset layout")), &QAction::triggered, this, [this] {
    full_->setChecked(false);
    window_.restoreState(first_);
  });
  QAction* const copied = edit.addAction(tr("Copy picture"), this, &ViewCommands::copy);
  copied->setShortcut(QKeySequence("Ctrl+Shift+C"));
  copied->setToolTip(tr("What the view under the pointer shows, for other programs"));
  window_.installEventFilter(this);
}

bool ViewCommands::eventFilter(QObject* object, QEvent* event) {
  // The next start is to have all of the window.
  if (object == &window_ && event->type() == QEvent::Close) full_->setChecked(false);
  return QObject::eventFilter(object, event);
}

QWidget* ViewCommands::view_in_use() const {
  for (QWidget* const view : views_)
    if (view->isAncestorOf(QApplication::focusWidget()) || view->hasFocus()) return view;
  for (QWidget* const view : views_)
    if (view->underMouse()) return view;
  return views_.front();
}

void ViewCommands::set_full(bool on) {
  const QWidget* const chosen = view_in_use();
  if (on) {
    before_full_ = window_.saveState();
    for (QDockWidget* dock : window_.findChildren<QDockWidget*>()) dock->hide();
  }
  for (QWidget* const view : views_) view->setVisible(!on || view == chosen);
  views_[0]->parentWidget()->setVisible(!on || chosen != views_[2]);
  if (!on) window_.restoreState(before_full_);
}

void ViewCommands::copy() {
  QWidget* const view = view_in_use();
  QApplication::clipboard()->setImage(view == &scene_ ? scene_.picture() : view->grab().toImage());
  window_.statusBar()->showMessage(tr("picture copied"), 8000);
}

}  // namespace plenoflame::desktop
