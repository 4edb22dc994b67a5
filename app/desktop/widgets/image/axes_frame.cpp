#include "widgets/image/axes_frame.h"

#include <QHBoxLayout>
#include <QPainter>
#include <algorithm>
#include <cmath>

#include "plenoflame/math/readable.h"
#include "widgets/image/image_view.h"

namespace plenoflame::desktop {
namespace {

constexpr int kMark = 4;  ///< [logical pixel]

}  // namespace

AxesFrame::AxesFrame(const char* name, QWidget* parent)
    : QWidget(parent), view_(new ImageView(this)) {
  view_->setObjectName(name);
  view_->set_smooth(false);
  view_->setMinimumSize(60, 60);
  const int line = fontMetrics().height();
  auto* layout = new QHBoxLayout(this);
  // Room for a line of numbers and one of the name below, for upright name and numbers beside.
  layout->setContentsMargins(line + fontMetrics().horizontalAdvance("-1000") + kMark, line / 2, 0,
                             2 * line + kMark);
  layout->addWidget(view_);
  connect(view_, &ImageView::view_changed, this, QOverload<>::of(&QWidget::update));
}

void AxesFrame::set_axes(const Axis& across, const Axis& up) {
  axes_ = {across, up};
  update();
}

void AxesFrame::draw_axis(QPainter& painter, bool upright) {
  const Axis& axis = axes_[upright];
  const auto& image = view_->image();
  if (axis.name.isEmpty() || !image || image->empty()) return;
  const QRect inner = view_->geometry();
  const double pixels = upright ? image->height() : image->width();
  const double step = tick_step(std::fabs(axis.last - axis.first),
                                std::max(1, (upright ? inner.height() : inner.width()) / 60));
  const double low = std::min(axis.first, axis.last), high = std::max(axis.first, axis.last);
  const int line = fontMetrics().height();
  for (double tick = std::ceil(low / step) * step; tick <= high; tick += step) {
    const double share = (tick - axis.first) / (axis.last - axis.first);
    const QPointF place =
        view_->to_widget(upright ? QPointF(0, (1 - share) * pixels) : QPointF(share * pixels, 0));
    const double at = upright ? inner.top() + place.y() : inner.left() + place.x();
    if (at < (upright ? inner.top() : inner.left()) ||
        at > (upright ? inner.bottom() : inner.right()) + 1)
      continue;
    const QString text = QString::number(std::fabs(tick) < 1e-9 * step ? 0 : tick, 'g', 6);
    if (upright) {
      painter.drawLine(QPointF(inner.left() - kMark, at), QPointF(inner.left(), at));
      painter.drawText(QRectF(0, at - line, inner.left() - kMark - 2, 2 * line),
                       Qt::AlignRight | Qt::AlignVCenter, text);
    } else {
      painter.drawLine(QPointF(at, inner.bottom()), QPointF(at, inner.bottom() + kMark));
      painter.drawText(QRectF(at - 60, inner.bottom() + kMark, 120, line), Qt::AlignCenter, text);
    }
  }
  painter.save();
  if (upright) {
    painter.translate(0, inner.bottom());
    painter.rotate(-90);
    painter.drawText(QRectF(0, 0, inner.height(), line), Qt::AlignCenter, axis.name);
  } else {
    painter.drawText(QRectF(inner.left(), inner.bottom() + kMark + line, inner.width(), line),
                     Qt::AlignCenter, axis.name);
  }
  painter.restore();
}

void AxesFrame::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  painter.setPen(palette().color(QPalette::WindowText));
  draw_axis(painter, false);
  draw_axis(painter, true);
}

}  // namespace plenoflame::desktop
