#pragma once
#include <QString>
#include <QWidget>
#include <array>

namespace plenoflame::desktop {

class ImageView;

/// A picture of a plane with axes in millimetres at its left and lower edge.
class AxesFrame : public QWidget {
  Q_OBJECT
 public:
  explicit AxesFrame(const char* name, QWidget* parent = nullptr);
  ImageView& view() { return *view_; }

  /// Places along one side of the picture: that of its first edge, at the left or below, and of its
  /// last one.
  struct Axis {
    QString name;
    double first = 0, last = 0;  ///< [mm]
  };
  /// An axis without a name is not drawn.
  void set_axes(const Axis& across, const Axis& up);
  const Axis& across() const { return axes_[0]; }
  const Axis& up() const { return axes_[1]; }

 protected:
  void paintEvent(QPaintEvent* event) override;

 private:
  void draw_axis(QPainter& painter, bool upright);

  ImageView* view_;
  std::array<Axis, 2> axes_;
};

}  // namespace plenoflame::desktop
