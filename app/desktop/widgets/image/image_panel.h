#pragma once
#include <vtkImageData.h>
#include <vtkSmartPointer.h>

#include <QTimer>
#include <QWidget>
#include <memory>

#include "model/document.h"
#include "model/image_display.h"
#include "model/jobs/latest_task.h"
#include "model/jobs/measured_picture.h"
#include "plenoflame/base/units.h"
#include "plenoflame/lightfield/colour.h"
#include "widgets/image/image_view.h"

class QAction;
class QComboBox;
class QLabel;
class QLineEdit;

namespace plenoflame::desktop {

/// Dimension of the values of a light field; none for electrons and counts.
Dimension dimension_of(const LightField& field);

class PlotWidget;
class ToolRow;

/// The raw light field with everything about how it is shown.
class ImagePanel : public QWidget {
  Q_OBJECT
 public:
  enum class Quantity { flux, standard_error, relative_error };

  /// The pictures that a measured one can be held against.
  enum class Picture { simulated, measured, overlay };

  ImagePanel(Document& document, MeasuredPicture& measured, QWidget* parent = nullptr);

  ImageView& view() { return *view_; }
  /// Histogram and line profile, for a dock of their own.
  PlotWidget& histogram_plot() { return *histogram_plot_; }
  PlotWidget& profile_plot() { return *profile_plot_; }
  /// The picture that is shown now; null: none yet.
  const std::shared_ptr<const ImagePyramid>& pyramid() const { return pyramid_; }
  /// Its flux as it is seen on the sensor in 3-D; null: none yet.
  const vtkSmartPointer<vtkImageData>& on_sensor() const { return on_sensor_; }
  /// True if the document's image is shown, and not an earlier one.
  bool is_current() const { return shown_ == newest_ && !measured_task_.busy(); }
  /// True while the picture of the document before is shown, as there is none of this one yet.
  bool is_left_over() const { return left_over_; }
  /// No picture follows that one.
  void drop_left_over();
  /// The picture that is drawn now, while they blink: this one of the two.
  Picture picture() const;
  /// The colours of the picture, which those of views follow.
  ColourMap map() const;
  /// The picture as it is shown, the whole of it, of another size [pixel] on another ground.
  /// @param metres receives the length on the sensor of a pixel of it; 0: there is no picture
  QImage poster(const QSize& size, const QColor& background, double& metres) const;
  QAction* outlines_action() { return outlines_; }
  /// Description of a pixel for the status bar: "flux 1.2 nW +- 0.1 nW".
  QString describe(int column, int row) const;
  /// The flux alone: "1.2 nW +- 0.1 nW"; empty: there is no such pixel.
  QString flux_text(int column, int row) const;

 signals:
  /// The flux, ready to be shown elsewhere, too.
  void pyramid_changed();
  void map_changed(plenoflame::ColourMap map);

 private:
  void request();
  bool fits_camera() const;
  void drop_picture();
  void apply_tone();
  void update_profile();
  void show_histogram(const Histogram& counts);
  void make_choice_of_picture(ToolRow& tools);
  void request_measured();
  void show_picture();
  double measured_white() const;
  /// The light field whose values are drawn, and their unit.
  const LightField* drawn_field() const;
  /// Channel of a field whose values are shown; with colours, that of their brightness.
  std::size_t channel_of(const LightField& field) const;
  ColourChannels colours_of(const LightField& field) const;
  Dimension dimension() const;
  bool shows_relative_error() const;
  QString value_text(const LightField& field, int column, int row) const;
  QString value_title(const LightField* field, bool relative_error) const;

  Document& document_;
  ImageView* view_;
  PlotWidget* histogram_plot_;
  PlotWidget* profile_plot_;
  QComboBox *quantity_, *channel_, *scale_, *map_;
  QLineEdit* white_;
  QAction *outlines_, *saturation_;
  std::shared_ptr<const ImagePyramid> pyramid_, flux_pyramid_;
  vtkSmartPointer<vtkImageData> on_sensor_;
  std::shared_ptr<const ImageView::Colours> colours_;  ///< null: one channel is shown
  double automatic_white_ = 1, automatic_saturation_ = 0;
  QLineF profile_;
  unsigned newest_ = 0, shown_ = 0;
  bool left_over_ = false;

  MeasuredPicture& measured_;
  QComboBox* picture_ = nullptr;
  QAction* blink_ = nullptr;
  QLabel* registration_ = nullptr;
  std::shared_ptr<const ImagePyramid> measured_pyramid_;
  double own_white_ = 1;  ///< of the measured picture
  bool blinked_ = false;  ///< the other picture has its turn
  QTimer blinking_;
  LatestTask measured_task_{Urgency::waited_for};
  LatestTask task_{Urgency::waited_for};  ///< last: it ends first
};

}  // namespace plenoflame::desktop
