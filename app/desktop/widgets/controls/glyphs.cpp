#include "widgets/controls/glyphs.h"

#include <QAction>
#include <QApplication>
#include <QIconEngine>
#include <QPainter>
#include <QPalette>
#include <QToolButton>

namespace plenoflame::desktop {
namespace {

class GlyphEngine : public QIconEngine {
 public:
  explicit GlyphEngine(Glyph glyph) : glyph_(glyph) {}

  QIconEngine* clone() const override { return new GlyphEngine(glyph_); }
  QPixmap pixmap(const QSize& size, QIcon::Mode mode, QIcon::State state) override {
    QPixmap drawn(size);
    drawn.fill(Qt::transparent);
    QPainter painter(&drawn);
    paint(&painter, QRect(QPoint(0, 0), size), mode, state);
    return drawn;
  }
  void paint(QPainter* painter, const QRect& rect, QIcon::Mode mode, QIcon::State) override {
    const QPalette palette = QApplication::palette();
    const QColor ink = palette.color(
        mode == QIcon::Disabled ? QPalette::Disabled : QPalette::Active, QPalette::ButtonText);
    painter->save();
    painter->setRenderHint(QPainter::Antialiasing);
    painter->translate(rect.topLeft());
    painter->scale(rect.width() / 16.0, rect.height() / 16.0);
    painter->setPen(QPen(ink, 1.4, Qt::SolidLine, Qt::RoundCap, Qt::RoundJoin));
    draw(*painter, ink);
    painter->restore();
  }

 private:
  void draw(QPainter& p, const QColor& ink) const {
    switch (glyph_) {
      case Glyph::ruler:
        p.drawRect(QRectF(1, 5.5, 14, 5.5));
        for (const double x : {4.0, 6.7, 9.4, 12.1})
          p.drawLine(QPointF(x, 5.5), QPointF(x, x == 6.7 || x == 12.1 ? 8.6 : 7.6));
        return;
      case Glyph::picture:
        p.drawRect(QRectF(1.5, 4.5, 13, 9));
        p.drawLine(QPointF(5.5, 2.5), QPointF(10.5, 2.5));
        p.drawEllipse(QPointF(8, 9), 2.6, 2.6);
        return;
      case Glyph::shortened:  // a line with a break in it, between two things
        p.setBrush(ink);
        p.drawRect(QRectF(1, 4.5, 2.2, 7));
        p.drawRect(QRectF(12.8, 4.5, 2.2, 7));
        p.setBrush(Qt::NoBrush);
        p.drawLine(QPointF(3.2, 8), QPointF(6, 8));
        p.drawLine(QPointF(10, 8), QPointF(12.8, 8));
        p.drawLine(QPointF(5.2, 11), QPointF(7, 5));
        p.drawLine(QPointF(9, 11), QPointF(10.8, 5));
        return;
      case Glyph::hand:  // arrows to four sides
        for (int turn = 0; turn < 4; ++turn) {
          p.drawLine(QPointF(8, 8), QPointF(8, 1.8));
          p.drawLine(QPointF(8, 1.8), QPointF(6, 4));
          p.drawLine(QPointF(8, 1.8), QPointF(10, 4));
          p.translate(8, 8);
          p.rotate(90);
          p.translate(-8, -8);
        }
        return;
      case Glyph::lenses:
        for (const QPointF middle : {QPointF(4.5, 4.7), QPointF(11.5, 4.7), QPointF(8, 11)})
          p.drawEllipse(middle, 3.3, 3.3);
        return;
      case Glyph::saturated:  // a curve that becomes flat, under a line
        p.drawLine(QPointF(1, 3), QPointF(15, 3));
        for (const QLineF& piece :
             {QLineF(1, 14, 4.5, 11), QLineF(4.5, 11, 6.5, 5.5), QLineF(6.5, 5.5, 15, 5.5)})
          p.drawLine(piece);
        return;
      case Glyph::more:  // two sliders
        for (const double x : {5.0, 11.0}) {
          p.drawLine(QPointF(x, 2), QPointF(x, 14));
          p.setBrush(ink);
          p.drawEllipse(QPointF(x, x < 8 ? 5.5 : 10.5), 2, 2);
        }
        return;
      case Glyph::light:  // a ray with light on it
        p.drawLine(QPointF(1, 13), QPointF(15, 3));
        p.setBrush(ink);
        for (const double t : {0.2, 0.5, 0.8})
          p.drawEllipse(QPointF(1 + 14 * t, 13 - 10 * t), 1.7, 1.7);
        return;
    }
  }
  Glyph glyph_;
};

/// Without the two spaces that Qt puts beside a text: several of them have to fit side by side.
class TextButton : public QToolButton {
 public:
  using QToolButton::QToolButton;
  QSize sizeHint() const override {
    return QToolButton::sizeHint() - QSize(2 * fontMetrics().horizontalAdvance(' '), 0);
  }
};

}  // namespace

QIcon glyph_icon(Glyph glyph) {
  return QIcon(new GlyphEngine(glyph));
}

QToolButton* button_for(QAction* action, QWidget* parent, bool icon_only) {
  auto* const button = icon_only ? new QToolButton(parent) : new TextButton(parent);
  button->setDefaultAction(action);
  button->setAutoRaise(true);
  button->setToolButtonStyle(icon_only ? Qt::ToolButtonIconOnly : Qt::ToolButtonTextOnly);
  return button;
}

}  // namespace plenoflame::desktop
