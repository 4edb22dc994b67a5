#pragma once
#include <QImage>
#include <QPointF>
#include <QWidget>
#include <memory>
#include <vector>

#include "model/jobs/ray_selector.h"
#include "plenoflame/scene/compile.h"

namespace plenoflame::desktop {

/// Section through the optical axis, the scene on the left, the sensor on the right. It shows
/// surfaces with their true shape, stop, microlenses, the flame's temperature in the plane, and the
/// rays seen from the side.
class SectionView : public QWidget {
  Q_OBJECT
 public:
  /// As those of the 3-D view.
  enum class Part { scene, flame, camera, array, pixel };

  explicit SectionView(QWidget* parent = nullptr);

  /// Null: nothing is shown.
  void set_scene(std::shared_ptr<const CompiledScene> scene);
  /// Why it does not show the present scene; empty: it does.
  void set_notice(const QString& text);
  /// @param chosen the ray that stands out; -1: none
  void set_rays(std::shared_ptr<const SelectedRays> rays, int chosen = -1);
  void show_part(Part part);
  /// The ray that stands out; -1: none.
  void set_highlighted(int ray);
  /// The plane: up and down as the picture, or across.
  void set_horizontal(bool on);

  /// Place on the widget at which a place of the plane is drawn. @param z of the camera  @param
  /// height above its axis [m]
  QPointF to_widget(double z, double height) const;

  /// Names of the parts as they were drawn last, and where [logical pixel].
  const std::vector<std::pair<QString, QRectF>>& names() const { return names_; }

  QSize sizeHint() const override { return {640, 220}; }

 signals:
  void lens_clicked(const plenoflame::LensIndex& lens);
  void point_clicked(const plenoflame::Vec3& point);
  /// The thing that the pointer is over, for the status bar; empty: nothing.
  void pointed(const QString& text);

 protected:
  void paintEvent(QPaintEvent* event) override;
  void wheelEvent(QWheelEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;
  void mouseReleaseEvent(QMouseEvent* event) override;
  void leaveEvent(QEvent* event) override;
  void resizeEvent(QResizeEvent* event) override;

 private:
  double title_height() const;
  double middle_row() const;
  /// The microlens at a place of the plane; false: there is none.
  bool lens_at(QPointF place, LensIndex& lens) const;
  Vec3 world_at(QPointF place) const;
  QPointF from_widget(QPointF place) const;  ///< x: camera z, y: height
  QPointF project(Vec3 world) const;         ///< the same of a point
  void draw_flame(QPainter& painter);
  void draw_lens(QPainter& painter);
  void draw_array(QPainter& painter);
  void draw_rays(QPainter& painter);
  void draw_scale(QPainter& painter);
  void draw_text(QPainter& painter, QPointF top_left, const QString& text);
  void draw_names(QPainter& painter);
  void draw_notice(QPainter& painter);
  void aim();
  bool is_close() const { return part_ == Part::array || part_ == Part::pixel; }
  void sample_flame();

  std::shared_ptr<const CompiledScene> scene_;
  std::shared_ptr<const SelectedRays> rays_;
  Part part_ = Part::scene;
  bool horizontal_ = false, dragging_ = false;
  bool touched_ = false;  ///< moved or zoomed by hand, and therefore left there
  int highlighted_ = -1;
  double scale_ = 1000;   ///< screen pixels per metre
  QPointF centre_{0, 0};  ///< camera z, height
  QPointF pressed_, last_;
  QString notice_;
  std::vector<std::pair<QString, QRectF>> names_;
  QImage flame_;
  QRectF flame_place_;  ///< left: largest z; in metres
};

/// Colour of the chosen ray, the same in all views.
QColor chosen_colour();
/// Colour of a ray by how it ended, the same in all views.
QColor status_colour(RayStatus status, bool dark_background);

}  // namespace plenoflame::desktop
