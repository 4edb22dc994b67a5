#include "widgets/window/lens_window.h"

#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QTableWidget>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "plenoflame/base/error.h"
#include "plenoflame/base/units.h"
#include "plenoflame/camera/camera.h"
#include "plenoflame/optics/surface_shape.h"
#include "plenoflame/scene/glass_indices.h"
#include "widgets/controls/plot_widget.h"

namespace plenoflame::desktop {
namespace {

enum Column { kRadius, kThickness, kGlass, kSemiDiameter, kConic, kStop, kLensColumns };
constexpr double kGreatestFrequency = 100e3;  ///< [1/m] beyond which no contrast is shown
constexpr int kFrequencySteps = 50;
constexpr double kSpotMark = 1;  ///< [logical pixel] radius of a ray, so that dense ones stay apart

QString length_cell(double length) {
  return QString::fromStdString(readable_quantity(length, Dimension::length, 6));
}

/// Path of the shown camera among the scene's keys.
std::string camera_path(const Document& document) {
  const auto& cameras = document.scene().cameras;
  for (std::size_t i = 0; i < cameras.size(); ++i)
    if (cameras[i].name == document.camera_name()) return "cameras[" + std::to_string(i) + "]";
  return "camera";
}

/// Range of frequencies [1/m] in which the contrast falls. A Gaussian spot of RMS radius r has
/// exp(-(pi r f)^2), of which a two-hundredth is left at 0.73 / r. Beyond that the few hundred rays
/// of a spot carry no information.
double shown_frequency(const std::array<const LensFieldDesign*, 3>& fields) {
  double least = kInfinity;
  for (const LensFieldDesign* field : fields) least = std::min(least, field->rms);
  const double wanted = 0.73 / least;
  if (!(wanted < kGreatestFrequency)) return kGreatestFrequency;
  const double power = std::pow(10.0, std::floor(std::log10(wanted)));
  for (const double digit : {1.0, 2.0, 5.0})
    if (digit * power >= wanted) return digit * power;
  return 10 * power;
}

std::array<const LensFieldDesign*, 3> shown_fields(const LensDesign& design) {
  const std::size_t last = design.fields.size() - 1;
  return {&design.fields[0], &design.fields[last * 7 / 10], &design.fields[last]};
}

}  // namespace

LensTable::LensTable(Document& document, QWidget* parent)
    : QDialog(parent),
      document_(document),
      table_(new QTableWidget(0, kLensColumns, this)),
      figures_(new QLabel(this)) {
  setObjectName("lensTableWindow");
  setWindowTitle(tr("Lens data"));
  table_->setObjectName("lensTable");
  table_->setHorizontalHeaderLabels({tr("Radius"), tr("Thickness"), tr("Glass or index behind"),
                                     tr("Semi-diameter"), tr("Conic"), tr("Stop")});
  table_->horizontalHeader()->setSectionResizeMode(QHeaderView::Stretch);
  table_->horizontalHeader()->setSectionResizeMode(kGlass, QHeaderView::ResizeToContents);
  table_->setAlternatingRowColors(true);
  table_->setToolTip(
      tr("From the scene to the sensor. Double click to change a figure, with unit"));
  figures_->setObjectName("lensFigures");
  figures_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  auto* layout = new QVBoxLayout(this);
  layout->addWidget(figures_);
  layout->addWidget(table_, 1);
  resize(760, 420);
  connect(&document_, &Document::scene_changed, this, &LensTable::fill);
  connect(table_, &QTableWidget::cellChanged, this, &LensTable::take);
  fill();
}

void LensTable::fill() {
  filling_ = true;
  const auto& surfaces = document_.camera().lens.surfaces;
  table_->setRowCount(static_cast<int>(surfaces.size()));
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const SurfaceSpec& s = surfaces[i];
    const auto set = [&](int column, const QString& text, bool editable) {
      auto* item = new QTableWidgetItem(text);
      if (!editable) item->setFlags(item->flags() & ~Qt::ItemIsEditable);
      table_->setItem(static_cast<int>(i), column, item);
    };
    const QString radii = QString::fromStdString(radii_in_words(s));  // of what is not round
    const bool round = radii.isEmpty();
    set(kRadius,
        !round                 ? radii
        : std::isinf(s.radius) ? QString("inf")
                               : length_cell(s.radius),
        round);
    set(kThickness, length_cell(s.thickness), true);
    set(kGlass,
        s.glass.empty() ? QString::number(s.index, 'g', 7) : QString::fromStdString(s.glass), true);
    set(kSemiDiameter, length_cell(0.5 * s.diameter), true);
    set(kConic, round ? QString::number(s.conic, 'g', 6) : QString(), round);
    set(kStop, s.stop ? tr("stop") : QString(), false);
  }
  filling_ = false;
  QString text = tr("An ideal lens: no surfaces.");
  if (!surfaces.empty() && document_.is_valid()) {
    try {
      Scene scene = document_.scene_of_camera().scene;
      set_indices(scene);
      const FirstOrder lens = first_order(scene.camera.lens.surfaces);
      text =
          tr("Focal length %1, f/%2, back focal distance %3, entrance pupil %4, at %5")
              .arg(length_cell(lens.focal_length))
              .arg(lens.focal_length / lens.entrance_pupil_diameter, 0, 'g', 4)
              .arg(length_cell(lens.back_focal_distance), length_cell(lens.entrance_pupil_diameter),
                   length_cell(design_wavelength(scene)));
    } catch (const std::exception& error) {
      text = QString::fromUtf8(error.what());
    }
  } else if (!surfaces.empty()) {
    text = tr("The scene has an error; see its tree.");
  }
  figures_->setText(text);
}

void LensTable::take(int row, int column) {
  if (filling_) return;
  const QString text = table_->item(row, column)->text().trimmed();
  const std::string surface =
      camera_path(document_) + ".lens.surfaces[" + std::to_string(row) + "]";
  try {
    const std::string value = text.toStdString();
    switch (column) {
      case kRadius:
        document_.set_value(surface + ".radius", value);
        break;
      case kThickness:
        document_.set_value(surface + ".thickness", value);
        break;
      case kGlass: {
        bool is_number = false;
        static_cast<void>(text.toDouble(&is_number));
        document_.set_value(surface + (is_number ? ".index" : ".glass"), value);
        break;
      }
      case kSemiDiameter: {
        const double half = parse_quantity(value, Dimension::length);
        document_.set_value(surface + ".diameter", format_quantity(2 * half, Dimension::length));
        break;
      }
      case kConic:
        document_.set_value(surface + ".conic", value);
        break;
      default:
        break;
    }
  } catch (const Error& error) {
    emit failed(QString::fromUtf8(error.what()));
  }
  fill();  // as it is now, also where the value was refused
}

LensDiagrams::LensDiagrams(Kind kind, LensJob& job, QWidget* parent)
    : QDialog(parent), kind_(kind), job_(job) {
  const bool spots = kind == Kind::spots, fans = kind == Kind::fans;
  setObjectName(spots ? "spotWindow" : fans ? "fanWindow" : "mtfWindow");
  setWindowTitle(spots  ? tr("Spot diagram")
                 : fans ? tr("Ray fans")
                        : tr("MTF (geometric: rays, no diffraction)"));
  auto* layout = new QHBoxLayout(this);
  for (std::size_t i = 0; i < plots_.size(); ++i) {
    titles_[i] = new QLabel(this);
    titles_[i]->setWordWrap(true);
    plots_[i] = new PlotWidget(this);
    plots_[i]->setMinimumSize(250, 250);
    auto* column = new QVBoxLayout;
    column->addWidget(titles_[i]);
    column->addWidget(plots_[i], 1);
    layout->addLayout(column, 1);
  }
  resize(1000, 380);
  connect(&job_, &LensJob::result_changed, this, &LensDiagrams::show_result);
  job_.want();
  show_result();
}

void LensDiagrams::show_result() {
  const auto& design = job_.result();
  for (std::size_t i = 0; i < plots_.size(); ++i) {
    plots_[i]->set_empty_text(job_.failure().isEmpty() ? tr("Rays are being traced.")
                                                       : job_.failure());
    titles_[i]->clear();
    plots_[i]->set_series({});
  }
  if (!design) return;
  const auto fields = shown_fields(*design);
  for (std::size_t i = 0; i < plots_.size(); ++i)
    titles_[i]->setText(
        tr("at %1 deg, image height %2, RMS radius %3")
            .arg(fields[i]->field * 180 / std::numbers::pi, 0, 'f', 2)
            .arg(QString::fromStdString(
                     readable_quantity(fields[i]->image_height, Dimension::length, 4)),
                 QString::fromStdString(readable_quantity(fields[i]->rms, Dimension::length, 4))));
  if (kind_ == Kind::spots) show_spots(*design);
  if (kind_ == Kind::fans) show_fans(*design);
  if (kind_ == Kind::contrast) show_contrast(*design);
}

void LensDiagrams::show_spots(const LensDesign& design) {
  const auto fields = shown_fields(design);
  double most = 0;  // one scale for all three
  for (const LensFieldDesign* field : fields)
    for (const Vec2 at : field->spot) most = std::max({most, std::fabs(at.x), std::fabs(at.y)});
  for (std::size_t i = 0; i < plots_.size(); ++i) {
    PlotWidget::Series points, frame;
    points.colour = QColor(213, 94, 0);
    points.marks = true;
    points.line = false;
    points.mark = kSpotMark;
    for (const Vec2 at : fields[i]->spot) points.points << QPointF(1e6 * at.x, 1e6 * at.y);
    frame.colour = Qt::transparent;
    frame.points << QPointF(-1e6 * most, -1e6 * most) << QPointF(1e6 * most, 1e6 * most);
    plots_[i]->set_axes(tr("away from the axis [um]"), tr("across [um]"), false, false);
    plots_[i]->set_equal_scales(true);
    plots_[i]->set_series({frame, points});
  }
}

void LensDiagrams::show_fans(const LensDesign& design) {
  const auto fields = shown_fields(design);
  double most = 0;  // one scale for all three, with nothing in its middle
  for (const LensFieldDesign* field : fields)
    for (const auto* fan : {&field->tangential_fan, &field->sagittal_fan})
      for (const FanPoint& p : *fan)
        if (std::isfinite(p.error)) most = std::max(most, std::fabs(p.error));
  for (std::size_t i = 0; i < plots_.size(); ++i) {
    PlotWidget::Series tangential, sagittal, frame;
    tangential.name = tr("tangential");
    tangential.colour = QColor(0, 114, 178);
    sagittal.name = tr("sagittal");
    sagittal.colour = QColor(213, 94, 0);
    sagittal.dashed = true;
    for (const FanPoint& p : fields[i]->tangential_fan)
      tangential.points << QPointF(p.pupil, 1e6 * p.error);
    for (const FanPoint& p : fields[i]->sagittal_fan)
      sagittal.points << QPointF(p.pupil, 1e6 * p.error);
    plots_[i]->set_axes(tr("place in the entrance pupil"), tr("aberration [um]"), false, false);
    frame.colour = Qt::transparent;
    frame.points << QPointF(-1, -1e6 * most) << QPointF(1, 1e6 * most);
    plots_[i]->set_series({tangential, sagittal, frame});
  }
}

void LensDiagrams::show_contrast(const LensDesign& design) {
  const auto fields = shown_fields(design);
  const double greatest = shown_frequency(fields);
  for (std::size_t i = 0; i < plots_.size(); ++i) {
    PlotWidget::Series tangential, sagittal, frame;
    tangential.name = tr("tangential");
    tangential.colour = QColor(0, 114, 178);
    sagittal.name = tr("sagittal");
    sagittal.colour = QColor(213, 94, 0);
    sagittal.dashed = true;
    for (const MtfPoint& p : geometric_mtf(fields[i]->spot, greatest, kFrequencySteps)) {
      tangential.points << QPointF(1e-3 * p.frequency, p.tangential);
      sagittal.points << QPointF(1e-3 * p.frequency, p.sagittal);
    }
    frame.colour = Qt::transparent;
    frame.points << QPointF(0, 0) << QPointF(0, 1);
    plots_[i]->set_axes(tr("line pairs per mm in the image"), tr("contrast"), false, false);
    plots_[i]->set_series({frame, tangential, sagittal});
  }
}

}  // namespace plenoflame::desktop
