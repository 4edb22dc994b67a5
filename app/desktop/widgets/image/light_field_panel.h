#pragma once
#include <QWidget>
#include <array>
#include <memory>
#include <optional>

#include "model/document.h"
#include "model/image_display.h"
#include "model/jobs/light_field_jobs.h"

class QComboBox;
class QLabel;
class QLineEdit;
class QPushButton;
class QSlider;
class QSpinBox;
class QTabWidget;

namespace plenoflame::desktop {

class ImageView;
class Notice;

/// The stop of the main lens, with the places that views are made from: drag the point.
class AperturePad : public QWidget {
  Q_OBJECT
 public:
  explicit AperturePad(int grid, QWidget* parent = nullptr);
  int column() const { return column_; }
  int row() const { return row_; }
  void set_place(int column, int row);
  QSize sizeHint() const override { return {150, 150}; }

 signals:
  void moved(int column, int row);

 protected:
  void paintEvent(QPaintEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;
  void keyPressEvent(QKeyEvent* event) override;

 private:
  void move_to(QPointF place);
  QRectF disc() const;
  int grid_, column_, row_;
};

/// The light field and its uses, each as large as the panel: the raw image, views, refocused
/// pictures, total focus, epipolar slices and the reconstruction.
class LightFieldPanel : public QWidget {
  Q_OBJECT
 public:
  enum class Tab { raw, views, refocus, total, slice, reconstruction };

  /// @param picture the raw image  @param reconstruction the page of what is reconstructed
  LightFieldPanel(Document& document, LightFieldJobs& jobs, QWidget& picture,
                  QWidget& reconstruction, QWidget* parent = nullptr);

  /// Depth of the refocused picture [m].
  double depth() const { return depth_wanted_; }
  /// @throws InputError where there is no such depth
  void set_depth(double depth);
  /// The picture of the tab that is shown; null: none yet.
  std::shared_ptr<const Image> shown_image() const;
  QString shown_name() const;
  QTabWidget& tabs() { return *tabs_; }
  Tab tab() const;
  void show_tab(Tab tab);
  /// True if the shown picture is made from views, which cost time.
  bool shows_views() const { return tab() != Tab::raw && tab() != Tab::reconstruction; }
  /// Colours of all its pictures.
  void set_map(ColourMap map);
  /// @param failure why there are no pictures; empty: they are there or come
  /// @param old whether those that are shown are of the scene before
  void set_notice(const QString& failure, bool old);

 signals:
  void export_requested();
  void views_wanted();

 private:
  QWidget* make_views_tab();
  QWidget* make_refocus_tab();
  QWidget* make_total_tab();
  QWidget* make_epipolar_tab();
  void show_view();
  void show_refocused();
  void show_stack();
  void show_slice();
  void on_views_changed();
  void show_types();
  void place_depth(double depth);
  void request_refocus();
  void show(ImageView& view, std::shared_ptr<const Image> image, double white,
            bool is_depth = false);

  Document& document_;
  LightFieldJobs& jobs_;
  QTabWidget* tabs_;  ///< in the order of Tab
  Notice* notice_;
  AperturePad* pad_;
  ImageView *view_, *refocused_, *total_, *slice_;
  QLabel *view_label_, *refocus_label_, *total_label_, *slice_label_;
  QSlider *depth_, *aperture_, *line_;
  QLineEdit* depth_edit_;
  QComboBox *total_kind_, *slice_direction_, *type_;
  QSpinBox* planes_;
  double nearest_ = 0.5, farthest_ = 2;
  double depth_wanted_ = 0;            ///< [m] 0: none yet
  std::array<double, 2> range_{0, 0};  ///< [m] that suits the camera; 0: not known yet
  double white_ = 1;
  ColourMap map_ = ColourMap::inferno;
};

}  // namespace plenoflame::desktop
