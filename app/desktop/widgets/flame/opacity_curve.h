#pragma once
#include <QWidget>
#include <vector>

#include "model/flame_look.h"

class QPainter;

namespace plenoflame::desktop {

/// The curve of opacity over temperature, on the colours of temperature. A click adds a point, a
/// drag moves one, a right click or Delete removes it. Arrow keys move the chosen point (Shift: ten
/// times as far). N and P choose the next and the previous one; Insert adds one after it.
class OpacityCurve : public QWidget {
  Q_OBJECT
 public:
  explicit OpacityCurve(QWidget* parent = nullptr);

  void set_look(const FlameLook& look);
  /// Temperatures of the ends [K].
  void set_range(double cold, double hot);
  /// Distribution of the flame over temperature, drawn behind the curve.
  /// @param shares of equal steps from `coldest` to `hottest` [K]
  void set_histogram(double coldest, double hottest, std::vector<double> shares);
  /// Height of the histogram at a temperature [K], as a share of the highest one.
  double height_at(double temperature) const;
  int chosen() const { return chosen_; }
  QPointF to_widget(const OpacityPoint& point) const;
  QSize sizeHint() const override { return {220, 100}; }

 signals:
  /// @param stroke the same for all changes of one drag
  void edited(const std::vector<plenoflame::desktop::OpacityPoint>& points, int stroke);

 protected:
  void paintEvent(QPaintEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;
  void mouseReleaseEvent(QMouseEvent* event) override;
  void keyPressEvent(QKeyEvent* event) override;

 private:
  QRectF area() const;
  void paint_histogram(QPainter& painter, const QRectF& box) const;
  OpacityPoint from_widget(QPointF place) const;
  int point_near(QPointF place) const;
  void change(std::vector<OpacityPoint> points);
  QString text_of(const OpacityPoint& point) const;

  FlameLook look_;
  double cold_ = 0, hot_ = 0;
  double coldest_ = 0, hottest_ = 0;
  std::vector<double> heights_;
  int chosen_ = -1, stroke_ = 0;
  bool dragging_ = false;
};

}  // namespace plenoflame::desktop
