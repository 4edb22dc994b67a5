#pragma once
#include <QColor>
#include <QPointF>
#include <QString>
#include <QVector>
#include <QWidget>
#include <vector>

namespace plenoflame::desktop {

/// Curves over two axes, linear or logarithmic, with their scales; follows its data live.
class PlotWidget : public QWidget {
  Q_OBJECT
 public:
  struct Series {
    QString name;
    QVector<QPointF> points;  ///< gaps where a coordinate is not finite
    QColor colour;
    bool dashed = false, marks = false;
    bool line = true;      ///< false: marks alone
    double mark = 2.5;     ///< [logical pixel] radius of the marks
    double bar_width = 0;  ///< above 0: bars around the points, in units (decades) of the x axis
  };

  explicit PlotWidget(QWidget* parent = nullptr);

  void set_axes(const QString& x_label, const QString& y_label, bool log_x, bool log_y);
  /// A length along x is as long along y, as the shape of a spot needs it.
  void set_equal_scales(bool on);
  void set_series(std::vector<Series> series);
  const std::vector<Series>& series() const { return series_; }
  const QString& y_label() const { return y_label_; }
  /// Shown while there is nothing to draw.
  void set_empty_text(const QString& text);

  /// Rectangle in which curves are drawn [logical pixel]; empty before the first drawing.
  const QRectF& area() const { return area_; }
  /// The values that stand at the corners of area(): plain ones, or exponents of logarithmic axes.
  QRectF range() const { return {QPointF(x_low_, y_low_), QPointF(x_high_, y_high_)}; }

  QSize sizeHint() const override { return {360, 220}; }

 protected:
  void paintEvent(QPaintEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;

 private:
  struct Axis;
  std::vector<Series> series_;
  QString x_label_, y_label_, empty_text_;
  bool log_x_ = false, log_y_ = false, equal_scales_ = false;
  QRectF area_;
  double x_low_ = 0, x_high_ = 1, y_low_ = 0, y_high_ = 1;
};

}  // namespace plenoflame::desktop
