#include "widgets/image/colour_bar.h"

#include <QPainter>
#include <algorithm>
#include <array>
#include <cmath>

namespace plenoflame::desktop {
namespace {

constexpr int kWidth = 14;  ///< [logical pixel] of the bar itself
constexpr int kGap = 4;
constexpr int kLabels = 5;

/// The value that stands at a place of the scale, 0 to 1: tone() the other way
/// round.
double value_at(const ToneSettings& tone_of, double place) {
  if (tone_of.is_signed) return (2 * place - 1) * tone_of.white;
  if (tone_of.scale == ToneScale::logarithmic)
    return tone_of.white * std::pow(10.0, tone_of.decades * (place - 1));
  if (place <= 0) return 0;
  double low = 0, high = tone_of.white;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (tone(tone_of, middle) < place ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

ColourBar::ColourBar(QWidget* parent) : QWidget(parent) {
  setSizePolicy(QSizePolicy::Fixed, QSizePolicy::Expanding);
  setToolTip(tr("The values that the colours stand for"));
}

QSize ColourBar::sizeHint() const {
  return {kWidth + 3 * kGap + fontMetrics().horizontalAdvance(widest_), 120};
}

void ColourBar::set_tone(const ToneSettings& tone_of, Dimension dimension, const QString& unit) {
  tone_ = tone_of;
  QStringList labels;
  for (int i = 0; i < kLabels; ++i)
    labels << QString::fromStdString(readable_quantity(
                  value_at(tone_of, static_cast<double>(i) / (kLabels - 1)), dimension, 3)) +
                  (unit.isEmpty() ? QString() : " " + unit);
  if (labels != labels_) {
    labels_ = labels;
    const auto width = [this](const QString& text) {
      return fontMetrics().horizontalAdvance(text);
    };
    for (const QString& label : labels_)
      if (width(label) > width(widest_)) widest_ = label;
    updateGeometry();
  }
  update();
}

void ColourBar::paintEvent(QPaintEvent*) {
  if (labels_.isEmpty()) return;
  QPainter painter(this);
  const int half = fontMetrics().height() / 2 + 1;
  const QRect bar(kGap, half, kWidth, std::max(1, height() - 2 * half));
  for (int y = 0; y < bar.height(); ++y) {
    const double place = 1 - (y + 0.5) / bar.height();
    const Rgb c = colour(tone_.map, place);
    painter.fillRect(bar.left(), bar.top() + y, bar.width(), 1, QColor(c.red, c.green, c.blue));
  }
  painter.setPen(palette().color(QPalette::Mid));
  painter.drawRect(bar);
  painter.setPen(palette().color(QPalette::WindowText));
  for (int i = 0; i < labels_.size(); ++i) {
    const double y = bar.bottom() - static_cast<double>(i) / (kLabels - 1) * bar.height();
    painter.drawText(QRectF(bar.right() + kGap, y - half, width(), 2 * half),
                     Qt::AlignLeft | Qt::AlignVCenter, labels_[i]);
  }
}

}  // namespace plenoflame::desktop
