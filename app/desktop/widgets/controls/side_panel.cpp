#include "widgets/controls/side_panel.h"

#include <QAction>
#include <QEvent>
#include <QTimer>
#include <QToolButton>
#include <QVBoxLayout>
#include <algorithm>

namespace plenoflame::desktop {
namespace {

/// Keeps a widget as high as its layout needs at its width. Texts that wrap have more lines in a
/// narrow panel, and a scroll area does not ask for it.
class HeightKeeper : public QObject {
 public:
  using QObject::QObject;
  bool eventFilter(QObject* object, QEvent* event) override {
    auto* const widget = qobject_cast<QWidget*>(object);
    if (widget && (event->type() == QEvent::LayoutRequest || event->type() == QEvent::Resize))
      widget->setMinimumHeight(
          std::max(0, widget->layout()->minimumHeightForWidth(widget->width())));
    return false;
  }
};

}  // namespace

SidePanel::SidePanel(QWidget* parent) : QScrollArea(parent) {
  setObjectName("sidePanel");
  setFrameShape(QFrame::NoFrame);
  setWidgetResizable(true);
  setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  auto* all = new QWidget(this);
  column_ = new QVBoxLayout(all);
  column_->setContentsMargins(0, 0, 0, 0);
  column_->setSpacing(0);
  column_->addStretch(0);
  setWidget(all);
  all->installEventFilter(new HeightKeeper(all));
}

void SidePanel::add(const char* name, const QString& title, QWidget* content) {
  auto* whole = new QWidget(widget());
  whole->setObjectName(name);
  auto* action = new QAction(title, this);
  action->setCheckable(true);
  action->setToolTip(tr("Opens or closes this group"));
  auto* head = new QToolButton(whole);
  head->setObjectName(QString(name) + "Title");
  head->setDefaultAction(action);
  head->setAutoRaise(true);
  head->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
  head->setArrowType(Qt::RightArrow);
  head->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
  auto* rows = new QVBoxLayout(whole);
  rows->setContentsMargins(0, 0, 0, 0);
  rows->setSpacing(0);
  rows->addWidget(head);
  rows->addWidget(content, 1);
  content->hide();
  column_->insertWidget(static_cast<int>(groups_.size()), whole);
  groups_.push_back({whole, head, content, action});
  connect(action, &QAction::toggled, this, [this, whole, content, head](bool on) {
    head->setArrowType(on ? Qt::DownArrow : Qt::RightArrow);
    content->setVisible(on);
    column_->setStretchFactor(whole, on ? 1 : 0);
    // Its place is known once everything has been laid out.
    if (on) QTimer::singleShot(0, whole, [this, whole, head] { show_group(*whole, *head); });
  });
}

void SidePanel::show_group(QWidget& whole, QWidget& head) {
  ensureWidgetVisible(&whole, 0, 0);
  ensureWidgetVisible(&head, 0, 0);
}

bool SidePanel::open(const QString& name) {
  for (const Group& group : groups_) {
    if (group.whole->objectName() != name &&
        group.action->text().compare(name, Qt::CaseInsensitive) != 0)
      continue;
    show();
    group.action->setChecked(true);
    show_group(*group.whole, *group.head);
    return true;
  }
  return false;
}

std::vector<QAction*> SidePanel::groups() const {
  std::vector<QAction*> actions;
  for (const Group& group : groups_) actions.push_back(group.action);
  return actions;
}

QStringList SidePanel::opened() const {
  QStringList names;
  for (const Group& group : groups_)
    if (group.action->isChecked()) names << group.whole->objectName();
  return names;
}

void SidePanel::set_opened(const QStringList& names) {
  for (const Group& group : groups_)
    group.action->setChecked(names.contains(group.whole->objectName()));
}

}  // namespace plenoflame::desktop
