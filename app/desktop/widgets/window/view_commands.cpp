#include "widgets/window/view_commands.h"

#include <QAction>
#include <QApplication>
#include <QClipboard>
#include <QEvent>
#include <QMainWindow>
#include <QMenu>
#include <QMenuBar>
#include <QStatusBar>
#include <utility>

#include "widgets/scene/scene_view.h"

namespace plenoflame::desktop {

ViewCommands::ViewCommands(QMainWindow& window, SceneView& scene, QWidget& pictures,
                           std::vector<QWidget*> others, const std::array<QMenu*, 2>& view_and_edit)
    : QObject(&window),
      window_(window),
      scene_(scene),
      views_{&scene, &pictures},
      others_(std::move(others)) {
  full_ = view_and_edit[0]->addAction(tr("Full size"));
  full_->setObjectName("actionFull");
  full_->setCheckable(true);
  full_->setShortcut(Qt::Key_F11);
  full_->setToolTip(tr("The view under the pointer, or the one that has the focus, alone"));
  connect(full_, &QAction::toggled, this, &ViewCommands::show_alone);
  QAction* const copied =
      view_and_edit[1]->addAction(tr("Copy picture"), this, &ViewCommands::copy);
  copied->setShortcut(QKeySequence("Ctrl+Shift+C"));
  copied->setToolTip(tr("What the view under the pointer shows, for other programs"));
  window_.installEventFilter(this);
}

bool ViewCommands::eventFilter(QObject* object, QEvent* event) {
  // The next start is to have all of the window.
  if (object == &window_ && event->type() == QEvent::Close) set_full(false);
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
  full_->setChecked(on);
}

void ViewCommands::show_alone(bool on) {
  const QWidget* const chosen = view_in_use();
  if (on) {
    for (QWidget* const view : views_)
      if (view != chosen) hidden_.push_back(view);
    for (QWidget* const other : others_)
      if (other->isVisible()) hidden_.push_back(other);
  }
  for (QWidget* const widget : hidden_) widget->setVisible(!on);
  if (!on) hidden_.clear();
  // A menu bar that were hidden would take its shortcuts with it.
  window_.menuBar()->setMaximumHeight(on ? 0 : QWIDGETSIZE_MAX);
  window_.setWindowState(on ? window_.windowState() | Qt::WindowFullScreen
                            : window_.windowState() & ~Qt::WindowFullScreen);
}

void ViewCommands::copy() {
  QWidget* const view = view_in_use();
  const bool space = view == &scene_ && !scene_.shows_section();
  QApplication::clipboard()->setImage(space ? scene_.picture() : view->grab().toImage());
  window_.statusBar()->showMessage(tr("picture copied"), 8000);
}

}  // namespace plenoflame::desktop
