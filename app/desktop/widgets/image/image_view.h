#pragma once
#include <QImage>
#include <QLineF>
#include <QPointF>
#include <QWidget>
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "model/image_display.h"
#include "plenoflame/base/units.h"
#include "plenoflame/lightfield/micro_images.h"
#include "plenoflame/render/ray_paths.h"

namespace plenoflame::desktop {

/// Shows an image of any size: drag moves it, the wheel zooms about the pointer, down to single
/// pixels with their values. Only what is visible is coloured, so that the size does not matter.
///
/// Click: pixel_clicked; Shift+click: lens_clicked; Ctrl+drag: a line for profile_drawn. Keys:
/// arrows move the selected pixel, + and - zoom, F fits, 1 shows pixels one to one.
class ImageView : public QWidget {
  Q_OBJECT
 public:
  explicit ImageView(QWidget* parent = nullptr);

  /// The part of the image that is seen, without the ground around it.
  QImage drawn();
  /// Null: nothing. The part that is shown stays when the size does.
  void set_image(std::shared_ptr<const ImagePyramid> image);
  const std::shared_ptr<const ImagePyramid>& image() const { return image_; }
  void set_tone(const ToneSettings& settings);
  const ToneSettings& tone_settings() const { return tone_; }
  /// Lays another picture of the same size over it: this one in magenta, the other in green, grey
  /// where both are alike. Null: none. @param white value of the other one that is drawn as
  /// brightest
  void set_overlay(std::shared_ptr<const ImagePyramid> image, double white = 1);
  const std::shared_ptr<const ImagePyramid>& overlay() const { return overlay_; }
  /// Red, green and blue of a picture of the same size, in linear sRGB, that is drawn instead, as
  /// bright as the tone's white says. Null: none.
  using Colours = std::array<std::shared_ptr<const ImagePyramid>, 3>;
  void set_colours(std::shared_ptr<const Colours> colours);
  /// Name of the picture in its lower left corner; empty: none.
  void set_caption(const QString& text);
  const QString& caption() const { return caption_; }
  /// A word in the corner about the whole picture; empty: none.
  void set_badge(const QString& text);
  const QString& badge() const { return badge_; }
  /// Shown where there is no picture; empty: that there is none yet.
  void set_empty_text(const QString& text);
  /// Pixels are smoothed when they are enlarged.
  void set_smooth(bool on);
  /// Unit of the values for people, e.g. "W".
  void set_value_format(Dimension dimension) { dimension_ = dimension; }

  void fit();
  /// @param scale screen pixels (of the device) per image pixel
  void set_scale(double scale);
  double scale() const { return scale_; }
  void centre_on(double column, double row);
  QPointF centre() const { return centre_; }
  /// Image coordinates of a place on the widget, and back.
  QPointF to_image(QPointF widget) const;
  QPointF to_widget(QPointF image) const;

  /// Outlines of micro-images, coloured by the type of their lens; null: none.
  void set_micro_images(std::shared_ptr<const MicroImages> micro_images);
  void set_selected_pixel(std::optional<Pixel> pixel);
  void set_selected_lens(std::optional<LensIndex> lens);
  /// Pixels that are marked: where a point of the scene is seen.
  void set_marks(std::vector<Pixel> marks);
  void set_profile_line(const QLineF& line);

  QSize sizeHint() const override { return {640, 640}; }

 signals:
  void pixel_clicked(int column, int row);
  void lens_clicked(int column, int row);
  /// column -1: the pointer is not over the image
  void hovered(int column, int row, double value);
  void profile_drawn(const QLineF& line);
  void view_changed();

 protected:
  void paintEvent(QPaintEvent* event) override;
  void resizeEvent(QResizeEvent* event) override;
  void wheelEvent(QWheelEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;
  void mouseReleaseEvent(QMouseEvent* event) override;
  void leaveEvent(QEvent* event) override;
  void keyPressEvent(QKeyEvent* event) override;

 private:
  double screen_scale() const;  ///< logical screen pixels per image pixel
  void zoom(double factor, QPointF about);
  void draw_image(QPainter& painter);
  void draw_values(QPainter& painter);
  void draw_micro_images(QPainter& painter);
  void draw_marks(QPainter& painter);
  void draw_badge(QPainter& painter);
  void draw_caption(QPainter& painter);
  void make_tables();
  void moved();

  std::shared_ptr<const ImagePyramid> image_, overlay_;
  std::shared_ptr<const Colours> colours_;
  ToneSettings tone_;
  double overlay_white_ = 1;
  std::unique_ptr<ToneTable> table_;                   ///< null: out of date
  std::unique_ptr<ToneTable> grey_, grey_of_overlay_;  ///< null without overlay
  QImage canvas_;
  QString badge_, empty_text_, caption_;
  double scale_ = 1;
  QPointF centre_;
  bool fitted_ = true, smooth_ = false;
  std::shared_ptr<const MicroImages> micro_images_;
  std::optional<Pixel> selected_;
  std::optional<LensIndex> selected_lens_;
  std::vector<Pixel> marks_;
  QLineF profile_;
  QPointF pressed_, last_;
  bool dragging_ = false, profiling_ = false;
  Dimension dimension_ = Dimension::flux;
};

/// Colour of a microlens type, the same in all views.
QColor type_colour(int type);

}  // namespace plenoflame::desktop
