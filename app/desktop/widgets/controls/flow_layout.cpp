#include "widgets/controls/flow_layout.h"

#include <QWidget>
#include <algorithm>

namespace plenoflame::desktop {

FlowLayout::FlowLayout(QWidget* parent) : QLayout(parent) {
  setContentsMargins(3, 2, 3, 2);
  setSpacing(3);
}

FlowLayout::~FlowLayout() {
  for (QLayoutItem* item : items_) delete item;
}

void FlowLayout::addItem(QLayoutItem* item) {
  items_.push_back(item);
}

QLayoutItem* FlowLayout::itemAt(int index) const {
  return index >= 0 && index < count() ? items_[static_cast<std::size_t>(index)] : nullptr;
}

QLayoutItem* FlowLayout::takeAt(int index) {
  QLayoutItem* const item = itemAt(index);
  if (item) items_.erase(items_.begin() + index);
  return item;
}

QSize FlowLayout::minimumSize() const {
  QSize size;
  for (const QLayoutItem* item : items_) size = size.expandedTo(item->minimumSize());
  const QMargins around = contentsMargins();
  return size + QSize(around.left() + around.right(), around.top() + around.bottom());
}

void FlowLayout::setGeometry(const QRect& area) {
  QLayout::setGeometry(area);
  arrange(area, true);
}

int FlowLayout::arrange(const QRect& area, bool place) const {
  const QRect room = area.marginsRemoved(contentsMargins());
  int y = room.top();
  for (std::size_t first = 0; first < items_.size();) {
    int width = 0, height = 0, growing = 0;
    std::size_t end = first;
    for (; end < items_.size(); ++end) {
      if (items_[end]->isEmpty()) continue;
      const QSize wanted = items_[end]->sizeHint();
      const int with = width + (width > 0 ? spacing() : 0) + wanted.width();
      if (width > 0 && with > room.width()) break;
      width = with;
      height = std::max(height, wanted.height());
      growing += (items_[end]->expandingDirections() & Qt::Horizontal) != 0 ? 1 : 0;
    }
    const int more = growing > 0 ? std::max(0, room.width() - width) / growing : 0;
    int x = room.left();
    for (std::size_t i = first; place && i < end; ++i) {
      if (items_[i]->isEmpty()) continue;
      QSize size = items_[i]->sizeHint();
      if ((items_[i]->expandingDirections() & Qt::Horizontal) != 0) size.rwidth() += more;
      size.setWidth(std::min(size.width(), room.width()));
      items_[i]->setGeometry(QRect(QPoint(x, y + (height - size.height()) / 2), size));
      x += size.width() + spacing();
    }
    y += height + (end < items_.size() ? spacing() : 0);
    first = end;
  }
  return y - area.top() + contentsMargins().bottom();
}

}  // namespace plenoflame::desktop
