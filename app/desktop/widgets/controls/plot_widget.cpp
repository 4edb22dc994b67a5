#include "widgets/controls/plot_widget.h"

#include <QMouseEvent>
#include <QPainter>
#include <QPainterPath>
#include <QToolTip>
#include <algorithm>
#include <cmath>
#include <utility>

#include "widgets/controls/pointer.h"

namespace plenoflame::desktop {
namespace {

/// Steps between 1, 2 and 5 times a power of ten, so that about `count` of them fit.
double tick_step(double range, int count) {
  const double raw = range / std::max(1, count);
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double digit : {1.0, 2.0, 5.0})
    if (digit * power >= raw * (1 - 1e-12)) return digit * power;
  return 10 * power;
}

std::vector<double> ticks(double low, double high, bool logarithmic, int count) {
  std::vector<double> out;
  if (logarithmic) {
    // low and high are exponents.
    const int first = static_cast<int>(std::ceil(low - 1e-9)),
              last = static_cast<int>(std::floor(high + 1e-9));
    const int stride = std::max(1, (last - first + count) / std::max(1, count));
    for (int e = first; e <= last; e += stride) out.push_back(e);
    if (out.size() >= 2) return out;
    out.clear();
    for (int e = first - 1; e <= last; ++e)
      for (const double digit : {1.0, 2.0, 5.0}) {
        const double place = e + std::log10(digit);
        if (place >= low - 1e-9 && place <= high + 1e-9) out.push_back(place);
      }
    if (out.size() >= 2) return out;
    // A short stretch of the scale is as good as even.
    out.clear();
    for (const double value : ticks(std::pow(10.0, low), std::pow(10.0, high), false, count))
      if (value > 0) out.push_back(std::log10(value));
    return out;
  }
  const double step = tick_step(high - low, count);
  for (double i = std::ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i)
    out.push_back(i * step == 0 ? 0 : i * step);
  return out;
}

}  // namespace

PlotWidget::PlotWidget(QWidget* parent) : QWidget(parent) {
  setMinimumSize(160, 110);
  setMouseTracking(true);
}

void PlotWidget::set_axes(const QString& x_label, const QString& y_label, bool log_x, bool log_y) {
  x_label_ = x_label;
  y_label_ = y_label;
  log_x_ = log_x;
  log_y_ = log_y;
  update();
}

void PlotWidget::set_equal_scales(bool on) {
  equal_scales_ = on;
  update();
}

void PlotWidget::set_series(std::vector<Series> series) {
  series_ = std::move(series);
  update();
}

void PlotWidget::set_empty_text(const QString& text) {
  empty_text_ = text;
  update();
}

void PlotWidget::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  painter.fillRect(rect(), palette().color(QPalette::Base));
  const QColor ink = palette().color(QPalette::Text);
  QColor faint = ink;
  faint.setAlphaF(0.15);
  const auto place = [](double value, bool logarithmic) {
    return logarithmic ? std::log10(value) : value;
  };
  bool any = false;
  double x0 = 0, x1 = 0, y0 = 0, y1 = 0;
  for (const Series& series : series_)
    for (const QPointF& p : series.points) {
      const double x = place(p.x(), log_x_), y = place(p.y(), log_y_);
      if (!std::isfinite(x) || !std::isfinite(y)) continue;
      const double half = 0.5 * series.bar_width;
      const double foot = half > 0 && !log_y_ ? 0 : y;  // bars stand on nothing
      x0 = any ? std::min(x0, x - half) : x - half;
      x1 = any ? std::max(x1, x + half) : x + half;
      y0 = any ? std::min({y0, y, foot}) : std::min(y, foot);
      y1 = any ? std::max({y1, y, foot}) : std::max(y, foot);
      any = true;
    }
  painter.setPen(ink);
  if (!any) {
    painter.drawText(rect(), Qt::AlignCenter | Qt::TextWordWrap, empty_text_);
    area_ = {};
    return;
  }
  const auto widen = [](double& low, double& high, bool logarithmic) {
    if (high - low <= 1e-12 * std::max(std::fabs(low), std::fabs(high))) {
      const double by = logarithmic ? 0.3 : low == 0 ? 1 : 0.1 * std::fabs(low);
      low -= by;
      high += by;
    }
    const double margin = 0.04 * (high - low);
    if (logarithmic || low != 0) low -= margin;
    high += margin;
  };
  widen(x0, x1, log_x_);
  widen(y0, y1, log_y_);
  const QFontMetrics metrics = painter.fontMetrics();
  const int line = metrics.height();
  const int left = metrics.horizontalAdvance("0.0000") + line + 10, bottom = 2 * line + 8;
  // The legend has lines of its own, so that it hides no curve.
  struct Entry {
    const Series* series;
    QPointF at;
  };
  constexpr int kSample = 22, kGap = 14;  // [logical pixel] of line, and to what is beside it
  std::vector<Entry> legend;
  double across = left;
  int legend_lines = 0;
  for (const Series& series : series_) {
    if (series.name.isEmpty()) continue;
    const double wide = kSample + 6 + metrics.horizontalAdvance(series.name) + kGap;
    if (legend_lines == 0 || across + wide > width()) {
      across = left;
      ++legend_lines;
    }
    legend.push_back({&series, QPointF(across, 4 + line * (legend_lines - 1))});
    across += wide;
  }
  const int top = 8 + line * legend_lines;
  area_ = QRectF(left, top, std::max(20, width() - left - 14),
                 std::max(20, height() - bottom - 2 - top));
  if (equal_scales_) {
    const double unit = std::max((x1 - x0) / area_.width(), (y1 - y0) / area_.height());
    const auto fill = [unit](double& low, double& high, double length) {
      const double more = 0.5 * (unit * length - (high - low));
      low -= more;
      high += more;
    };
    fill(x0, x1, area_.width());
    fill(y0, y1, area_.height());
  }
  x_low_ = x0;
  x_high_ = x1;
  y_low_ = y0;
  y_high_ = y1;
  const auto to_x = [&](double x) { return area_.left() + (x - x0) / (x1 - x0) * area_.width(); };
  const auto to_y = [&](double y) {
    return area_.bottom() - (y - y0) / (y1 - y0) * area_.height();
  };
  const auto label = [](double tick, bool logarithmic) {
    return QString::number(logarithmic ? std::pow(10.0, tick) : tick, 'g', 4);
  };
  for (const double tick : ticks(x0, x1, log_x_, std::max(2, width() / 80))) {
    painter.setPen(faint);
    painter.drawLine(QPointF(to_x(tick), area_.top()), QPointF(to_x(tick), area_.bottom()));
    painter.setPen(ink);
    const QString text = label(tick, log_x_);
    const double half = 0.5 * metrics.horizontalAdvance(text) + 1;
    const double middle = std::min(to_x(tick), width() - half);  // the last one is whole, too
    painter.drawText(QRectF(middle - half, area_.bottom() + 2, 2 * half, line), Qt::AlignCenter,
                     text);
  }
  for (const double tick : ticks(y0, y1, log_y_, std::max(2, height() / 40))) {
    painter.setPen(faint);
    painter.drawLine(QPointF(area_.left(), to_y(tick)), QPointF(area_.right(), to_y(tick)));
    painter.setPen(ink);
    painter.drawText(QRectF(line + 4, to_y(tick) - line, left - line - 8, 2 * line),
                     Qt::AlignRight | Qt::AlignVCenter, label(tick, log_y_));
  }
  painter.drawRect(area_);
  painter.drawText(QRectF(area_.left(), area_.bottom() + line + 4, area_.width(), line),
                   Qt::AlignCenter, x_label_);
  painter.save();
  // Beside the middle of the axis, or as near to it as the whole text has room.
  const double half_label = 0.5 * metrics.horizontalAdvance(y_label_) + 2;
  painter.translate(2 + line, std::max(area_.center().y(), std::min(half_label, 0.5 * height())));
  painter.rotate(-90);
  painter.drawText(QRectF(-0.5 * height(), -line, height(), line), Qt::AlignCenter, y_label_);
  painter.restore();
  painter.setRenderHint(QPainter::Antialiasing);
  for (const Entry& entry : legend) {
    const Series& series = *entry.series;
    painter.setPen(QPen(series.colour, 1.6, series.dashed ? Qt::DashLine : Qt::SolidLine));
    painter.drawLine(entry.at + QPointF(0, 0.5 * line), entry.at + QPointF(kSample, 0.5 * line));
    painter.setPen(ink);
    painter.drawText(QRectF(entry.at.x() + kSample + 6, entry.at.y(),
                            width() - entry.at.x() - kSample - 6, line),
                     Qt::AlignLeft | Qt::AlignVCenter, series.name);
  }
  painter.setClipRect(area_);
  for (const Series& series : series_) {
    painter.setPen(QPen(series.colour, 1.6, series.dashed ? Qt::DashLine : Qt::SolidLine));
    QPainterPath path;
    bool pen_down = false;
    QPointF before;
    for (const QPointF& p : series.points) {
      const double x = place(p.x(), log_x_), y = place(p.y(), log_y_);
      if (!std::isfinite(x) || !std::isfinite(y)) {
        pen_down = false;
        continue;
      }
      const QPointF at(to_x(x), to_y(y));
      if (series.bar_width > 0) {
        const double half = std::max(1.0, 0.5 * series.bar_width / (x1 - x0) * area_.width());
        painter.fillRect(QRectF(at.x() - half, at.y(), 2 * half, area_.bottom() - at.y()),
                         series.colour);
        continue;
      }
      if (pen_down)
        path.lineTo(at);
      else
        path.moveTo(at);
      pen_down = true;
      // A line of a single point would not be seen.
      if (series.marks || series.points.size() == 1)
        painter.drawEllipse(at, series.mark, series.mark);
    }
    painter.setBrush(Qt::NoBrush);
    if (series.line) painter.drawPath(path);
  }
}

void PlotWidget::mouseMoveEvent(QMouseEvent* event) {
  const QPointF at = pointer_place(event);
  if (area_.isEmpty() || !area_.contains(at)) return QToolTip::hideText();
  double x = x_low_ + (at.x() - area_.left()) / area_.width() * (x_high_ - x_low_);
  double y = y_low_ + (area_.bottom() - at.y()) / area_.height() * (y_high_ - y_low_);
  if (log_x_) x = std::pow(10.0, x);
  if (log_y_) y = std::pow(10.0, y);
  QToolTip::showText(mapToGlobal(at.toPoint()),
                     QString("%1, %2").arg(x, 0, 'g', 4).arg(y, 0, 'g', 4), this);
}

}  // namespace plenoflame::desktop
