#include "widgets/flame/opacity_curve.h"

#include <QKeyEvent>
#include <QLinearGradient>
#include <QMouseEvent>
#include <QPainter>
#include <QToolTip>
#include <algorithm>
#include <cmath>
#include <utility>

#include "plenoflame/base/units.h"
#include "widgets/controls/pointer.h"

namespace plenoflame::desktop {
namespace {

constexpr double kReach = 9;   ///< [logical pixel] from a point to where a press takes it
constexpr double kRadius = 5;  ///< [logical pixel]
constexpr double kKeyStep = 0.01;
constexpr double kHistogramShare = 0.8;  ///< of the curve's height
constexpr int kGradientStops = 17;

}  // namespace

OpacityCurve::OpacityCurve(QWidget* parent) : QWidget(parent) {
  setFocusPolicy(Qt::StrongFocus);
  setMouseTracking(true);
  setMinimumSize(120, 84);
  setToolTip(
      tr("Opacity over temperature: how much of what absorbs is drawn. Click to add a point, drag "
         "to move it, right click or Delete takes it away; arrow keys move the chosen one, N and P "
         "choose, Insert adds. The light field does not depend on it."));
}

void OpacityCurve::set_look(const FlameLook& look) {
  look_ = look;
  chosen_ = std::min(chosen_, static_cast<int>(look_.points.size()) - 1);
  update();
}

void OpacityCurve::set_range(double cold, double hot) {
  cold_ = cold;
  hot_ = hot;
  update();
}

void OpacityCurve::set_histogram(double coldest, double hottest, std::vector<double> shares) {
  coldest_ = coldest;
  hottest_ = hottest;
  heights_ = std::move(shares);
  const double most = heights_.empty() ? 0 : *std::max_element(heights_.begin(), heights_.end());
  // By the root: a thin hot sheet is little beside all the warm gas, and is what shines.
  for (double& height : heights_) height = most > 0 ? std::sqrt(height / most) : 0;
  update();
}

double OpacityCurve::height_at(double temperature) const {
  if (heights_.empty() || temperature < coldest_ || temperature > hottest_) return 0;
  const double t = hottest_ > coldest_ ? (temperature - coldest_) / (hottest_ - coldest_) : 0.5;
  const auto last = heights_.size() - 1;
  return heights_[std::min(last, static_cast<std::size_t>(t * static_cast<double>(last + 1)))];
}

QRectF OpacityCurve::area() const {
  const double line = fontMetrics().height();
  return QRectF(rect()).adjusted(kRadius + 1, kRadius + 1, -kRadius - 1, -line - kRadius - 3);
}

QPointF OpacityCurve::to_widget(const OpacityPoint& point) const {
  const QRectF box = area();
  return {box.left() + point.place * box.width(), box.bottom() - point.opacity * box.height()};
}

OpacityPoint OpacityCurve::from_widget(QPointF place) const {
  const QRectF box = area();
  return {(place.x() - box.left()) / box.width(), (box.bottom() - place.y()) / box.height()};
}

int OpacityCurve::point_near(QPointF place) const {
  int best = -1;
  double least = kReach;
  for (std::size_t i = 0; i < look_.points.size(); ++i) {
    const QPointF d = to_widget(look_.points[i]) - place;
    const double distance = std::hypot(d.x(), d.y());
    if (distance > least) continue;
    least = distance;
    best = static_cast<int>(i);
  }
  return best;
}

void OpacityCurve::change(std::vector<OpacityPoint> points) {
  if (points == look_.points) return;
  look_.points = std::move(points);
  update();
  emit edited(look_.points, stroke_);
}

QString OpacityCurve::text_of(const OpacityPoint& point) const {
  const QString share = tr("%1 %").arg(100 * point.opacity, 0, 'f', 0);
  if (!(hot_ > cold_)) return share;
  return tr("%1: %2").arg(QString::fromStdString(readable_quantity(
                              cold_ + point.place * (hot_ - cold_), Dimension::temperature, 4)),
                          share);
}

void OpacityCurve::mousePressEvent(QMouseEvent* event) {
  const QPointF at = pointer_place(event);
  const int near = point_near(at);
  ++stroke_;
  if (event->button() == Qt::RightButton && near >= 0) {
    auto points = look_.points;
    remove_point(points, static_cast<std::size_t>(near));
    chosen_ = -1;
    return change(std::move(points));
  }
  if (event->button() != Qt::LeftButton) return;
  dragging_ = true;
  chosen_ = near;
  if (near < 0) {
    auto points = look_.points;
    chosen_ = static_cast<int>(add_point(points, from_widget(at)));
    change(std::move(points));
  }
  update();
}

void OpacityCurve::mouseMoveEvent(QMouseEvent* event) {
  const QPointF at = pointer_place(event);
  setCursor(point_near(at) >= 0 || dragging_ ? Qt::SizeAllCursor : Qt::CrossCursor);
  if (!dragging_ || chosen_ < 0) return;
  auto points = look_.points;
  move_point(points, static_cast<std::size_t>(chosen_), from_widget(at));
  const QString text = text_of(points[static_cast<std::size_t>(chosen_)]);
  change(std::move(points));
  QToolTip::showText(mapToGlobal(at.toPoint()), text, this);
}

void OpacityCurve::mouseReleaseEvent(QMouseEvent*) {
  dragging_ = false;
}

void OpacityCurve::keyPressEvent(QKeyEvent* event) {
  const int count = static_cast<int>(look_.points.size());
  const double step = (event->modifiers() & Qt::ShiftModifier) != 0 ? 10 * kKeyStep : kKeyStep;
  const auto move = [&](double place, double opacity) {
    if (chosen_ < 0) return;
    auto points = look_.points;
    OpacityPoint to = points[static_cast<std::size_t>(chosen_)];
    to.place += place;
    to.opacity += opacity;
    move_point(points, static_cast<std::size_t>(chosen_), to);
    change(std::move(points));
  };
  const auto choose = [&](int number) {
    chosen_ = (number + count) % count;
    ++stroke_;
    update();
  };
  switch (event->key()) {
    case Qt::Key_Left:
      return move(-step, 0);
    case Qt::Key_Right:
      return move(step, 0);
    case Qt::Key_Up:
      return move(0, step);
    case Qt::Key_Down:
      return move(0, -step);
    case Qt::Key_N:
      return choose(chosen_ + 1);
    case Qt::Key_P:
      return choose(std::max(0, chosen_) - 1);
    case Qt::Key_Delete:
    case Qt::Key_Backspace: {
      ++stroke_;
      auto points = look_.points;
      if (chosen_ < 0 || !remove_point(points, static_cast<std::size_t>(chosen_))) return;
      chosen_ = -1;
      return change(std::move(points));
    }
    case Qt::Key_Insert: {
      ++stroke_;
      auto points = look_.points;
      const auto from = static_cast<std::size_t>(std::clamp(chosen_, 0, count - 2));
      const double place = 0.5 * (points[from].place + points[from + 1].place);
      chosen_ = static_cast<int>(add_point(points, {place, opacity_at(points, place)}));
      return change(std::move(points));
    }
    default:
      QWidget::keyPressEvent(event);
  }
}

void OpacityCurve::paint_histogram(QPainter& painter, const QRectF& box) const {
  if (heights_.empty() || !(hot_ > cold_)) return;
  QColor ink = palette().color(QPalette::Text);
  ink.setAlphaF(0.35);
  painter.setPen(QPen(ink, 1));
  for (int x = 0; x < static_cast<int>(box.width()); ++x) {
    const double from = cold_ + (hot_ - cold_) * x / box.width(),
                 to = cold_ + (hot_ - cold_) * (x + 1) / box.width();
    // The highest value within the column, so that narrow peaks stay visible.
    double height = std::max(height_at(from), height_at(to));
    const double step = (hottest_ - coldest_) / static_cast<double>(heights_.size());
    for (double t = from; step > 0 && t < to; t += step) height = std::max(height, height_at(t));
    if (height <= 0) continue;
    const double at = box.left() + x + 0.5;
    painter.drawLine(QPointF(at, box.bottom()),
                     QPointF(at, box.bottom() - kHistogramShare * height * box.height()));
  }
}

void OpacityCurve::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  const QRectF box = area();
  QLinearGradient colours(box.topLeft(), box.topRight());
  for (int i = 0; i < kGradientStops; ++i) {
    const double t = static_cast<double>(i) / (kGradientStops - 1);
    const Rgb c = flame_colour(look_.map, t);
    colours.setColorAt(t, QColor(c.red, c.green, c.blue));
  }
  painter.fillRect(box, colours);
  painter.setRenderHint(QPainter::Antialiasing);
  // Temperatures that are not drawn are dimmed, so that the curve reads at a glance.
  QPolygonF line;
  for (const OpacityPoint& p : look_.points) line << to_widget(p);
  QPolygonF above = line;
  above << box.topRight() << box.topLeft();
  QColor veil = palette().color(QPalette::Base);
  veil.setAlphaF(0.75);
  painter.setPen(Qt::NoPen);
  painter.setBrush(veil);
  painter.drawPolygon(above);
  paint_histogram(painter, box);
  painter.setBrush(Qt::NoBrush);
  painter.setPen(QPen(palette().color(hasFocus() ? QPalette::Highlight : QPalette::Mid), 1));
  painter.drawRect(box);
  painter.setPen(QPen(palette().color(QPalette::Text), 1.6));
  painter.drawPolyline(line);
  for (std::size_t i = 0; i < look_.points.size(); ++i) {
    const bool here = static_cast<int>(i) == chosen_;
    painter.setBrush(palette().color(here ? QPalette::Highlight : QPalette::Base));
    painter.drawEllipse(to_widget(look_.points[i]), kRadius, kRadius);
  }
  if (!(hot_ > cold_)) return;
  const auto label = [&](double kelvin, int align) {
    painter.drawText(
        QRectF(box.left(), box.bottom() + kRadius, box.width(), height() - box.bottom() - kRadius),
        align, QString::fromStdString(readable_quantity(kelvin, Dimension::temperature, 4)));
  };
  label(cold_, Qt::AlignLeft);
  label(0.5 * (cold_ + hot_), Qt::AlignHCenter);
  label(hot_, Qt::AlignRight);
}

}  // namespace plenoflame::desktop
