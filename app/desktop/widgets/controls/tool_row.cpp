#include "widgets/controls/tool_row.h"

#include <QAction>
#include <QEvent>
#include <QFrame>
#include <QScreen>
#include <QToolButton>
#include <QVBoxLayout>
#include <algorithm>

#include "widgets/controls/flow_layout.h"
#include "widgets/controls/glyphs.h"

namespace plenoflame::desktop {

ToolRow::ToolRow(const char* name, const QString& about, QWidget* parent)
    : QWidget(parent), flow_(new FlowLayout(this)), popup_(new QFrame(this, Qt::Popup)) {
  popup_->setFrameShape(QFrame::StyledPanel);
  popup_->setAttribute(Qt::WA_NoMouseReplay);  // a click on the button closes it
  popup_->setObjectName(QString(name) + "Popup");
  lines_ = new QVBoxLayout(popup_);
  lines_->setContentsMargins(6, 6, 6, 6);
  auto* const action = new QAction(glyph_icon(Glyph::more), about, this);
  connect(action, &QAction::triggered, this, &ToolRow::open);
  more_ = button_for(action, this, true);
  more_->setObjectName(name);
  more_->setToolTip(about);
  flow_->addWidget(more_);
}

void ToolRow::add(QWidget* tool) {
  flow_->addWidget(tool);
  flow_->removeWidget(more_);
  flow_->addWidget(more_);
}

void ToolRow::add_spare(QWidget* tool) {
  spare_.push_back(tool);
  lines_->addWidget(tool);
}

void ToolRow::show_spare(bool on) {
  shown_ = on;
  arrange();
}

void ToolRow::resizeEvent(QResizeEvent* event) {
  QWidget::resizeEvent(event);
  arrange();
}

bool ToolRow::event(QEvent* event) {
  if (event->type() == QEvent::LayoutRequest) arrange();
  return QWidget::event(event);
}

void ToolRow::arrange() {
  const QMargins around = flow_->contentsMargins();
  const auto with_space = [this](int width) { return width + flow_->spacing(); };
  int room = width() - around.left() - around.right() + flow_->spacing();
  for (int i = 0; i < flow_->count(); ++i) {
    const QLayoutItem* const item = flow_->itemAt(i);
    const bool is_spare =
        std::find(spare_.begin(), spare_.end(), flow_->itemAt(i)->widget()) != spare_.end();
    if (!is_spare && !item->isEmpty() && flow_->itemAt(i)->widget() != more_)
      room -= with_space(item->sizeHint().width());
  }
  std::size_t inside = 0;
  if (shown_) {
    int all = 0;
    for (QWidget* const tool : spare_) all += with_space(QWidgetItem(tool).sizeHint().width());
    const int left = all <= room ? room : room - with_space(more_->sizeHint().width());
    for (int used = 0; inside < spare_.size(); ++inside) {
      used += with_space(QWidgetItem(spare_[inside]).sizeHint().width());
      if (used > left) break;
    }
  }
  more_->setVisible(shown_ && inside < spare_.size());
  if (placed_ && inside == inside_) return;
  placed_ = true;
  inside_ = inside;
  flow_->removeWidget(more_);
  for (std::size_t i = 0; i < spare_.size(); ++i) {
    flow_->removeWidget(spare_[i]);
    lines_->removeWidget(spare_[i]);
    if (i < inside)
      flow_->addWidget(spare_[i]);
    else
      lines_->addWidget(spare_[i]);
    spare_[i]->show();
  }
  flow_->addWidget(more_);
}

void ToolRow::open() {
  popup_->adjustSize();
  const QRect room = more_->screen()->availableGeometry();
  const QPoint below = more_->mapToGlobal(QPoint(0, more_->height()));
  popup_->move(
      std::clamp(below.x(), room.left(), std::max(room.left(), room.right() - popup_->width())),
      below.y());
  popup_->show();
}

}  // namespace plenoflame::desktop
