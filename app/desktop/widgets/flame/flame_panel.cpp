#include "widgets/flame/flame_panel.h"

#include <QComboBox>
#include <QHBoxLayout>
#include <QLabel>
#include <QPushButton>
#include <QSlider>
#include <QVBoxLayout>
#include <algorithm>
#include <array>
#include <vector>

#include "plenoflame/base/units.h"
#include "widgets/controls/flow_layout.h"
#include "widgets/controls/plot_widget.h"
#include "widgets/flame/flame_look_editor.h"
#include "widgets/image/image_view.h"

namespace plenoflame::desktop {
namespace {

QString text_of(double value, Dimension dimension) {
  return QString::fromStdString(readable_quantity(value, dimension, 4));
}

/// Shares of what absorbs in equal steps of temperature, from the coldest to the hottest.
std::vector<double> shares_by_temperature(const FlameSamples& samples) {
  constexpr std::size_t kSteps = 200;
  std::vector<double> shares(kSteps, 0.0);
  const double range = samples.hottest - samples.coldest;
  for (std::size_t i = 0; i < samples.temperature.size(); ++i) {
    if (samples.absorption[i] <= 0) continue;
    const double t =
        range > 0 ? (static_cast<double>(samples.temperature[i]) - samples.coldest) / range : 0.5;
    shares[std::min(kSteps - 1, static_cast<std::size_t>(t * kSteps))] += 1;
  }
  return shares;
}

/// Heights [logical pixel] that leave room for the whole panel in a window of 720.
constexpr int kLeastSlice = 70, kLeastHistogram = 90;

}  // namespace

FlamePanel::FlamePanel(Document& document, SceneCompiler& compiler, QWidget* parent)
    : QWidget(parent), document_(document), sampler_(compiler) {
  summary_ = new QLabel(tr("There is no flame yet."), this);
  summary_->setObjectName("flameSummary");
  summary_->setWordWrap(true);
  summary_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  const auto button = [this](const QString& text, const char* name, const QString& tip) {
    auto* b = new QPushButton(text, this);
    b->setObjectName(name);
    b->setToolTip(tip);
    return b;
  };
  auto* generate =
      button(tr("Generate..."), "flameGenerate",
             tr("Make a flame from a few figures: candle, diffusion flame, turbulent plume, ..."));
  auto* import = button(tr("Import..."), "flameImport",
                        tr("Take a flame from a simulation (VTK, OpenFOAM, ...)"));
  auto* mapping =
      button(tr("Grids..."), "flameMapping",
             tr("Which grids of the file are temperature and absorption, and in which units"));
  connect(generate, &QPushButton::clicked, this, &FlamePanel::generate_requested);
  connect(import, &QPushButton::clicked, this, &FlamePanel::import_requested);
  connect(mapping, &QPushButton::clicked, this, [this] {
    const auto& flames = document_.scene().flames;
    for (std::size_t i = 0; i < flames.size(); ++i)
      if (flames[i].kind == FlameKind::vdb) return emit mapping_requested(static_cast<int>(i));
    emit mapping_requested(-1);
  });
  axis_ = new QComboBox(this);
  axis_->addItems({tr("across x"), tr("across y"), tr("across z")});
  axis_->setToolTip(tr("Plane of the slice, in the world's axes"));
  quantity_ = new QComboBox(this);
  quantity_->addItems({tr("Temperature"), tr("Absorption")});
  quantity_->setToolTip(tr("What the slice shows: temperature [K] or absorption [1/m]"));
  position_ = new QSlider(Qt::Horizontal, this);
  position_->setObjectName("slicePosition");
  position_->setRange(0, 100);
  position_->setValue(50);
  position_->setToolTip(tr("Where the slice is cut"));
  place_ = new QLabel(this);
  slice_ = new ImageView(this);
  slice_->setObjectName("flameSlice");
  slice_->set_value_format(Dimension::temperature);
  slice_->setMinimumHeight(kLeastSlice);
  histogram_ = new PlotWidget(this);
  histogram_->setMinimumHeight(kLeastHistogram);
  histogram_->set_empty_text(tr("The distribution of temperature appears with a flame."));
  look_ = new FlameLookEditor(document, this);

  auto* buttons = new FlowLayout;
  buttons->setContentsMargins(0, 0, 0, 0);
  buttons->addWidget(generate);
  buttons->addWidget(import);
  buttons->addWidget(mapping);
  auto* cut = new QHBoxLayout;
  cut->addWidget(quantity_);
  cut->addWidget(axis_);
  cut->addWidget(position_, 1);
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(4, 4, 4, 4);
  layout->addLayout(buttons);
  layout->addWidget(summary_);
  layout->addLayout(cut);
  layout->addWidget(place_);
  layout->addWidget(slice_, 3);
  layout->addWidget(histogram_, 2);
  layout->addWidget(look_);

  const auto chosen = QOverload<int>::of(&QComboBox::currentIndexChanged);
  connect(axis_, chosen, this, &FlamePanel::show_slice);
  connect(quantity_, chosen, this, &FlamePanel::show_slice);
  connect(position_, &QSlider::valueChanged, this, &FlamePanel::show_slice);
  connect(&sampler_, &FlameSampler::samples_changed, this, &FlamePanel::fill);
}

void FlamePanel::fill() {
  const auto samples = sampler_.samples();
  if (!samples || samples->temperature.empty()) {
    summary_->setText(tr("The scene has no flame."));
    slice_->set_image(nullptr);
    histogram_->set_series({});
    return;
  }
  const Vec3 size = samples->box.upper - samples->box.lower;
  QString text =
      tr("%1 x %2 x %3, %4 to %5 where it absorbs, mean of the emission %6; absorption up to %7")
          .arg(text_of(size.x, Dimension::length), text_of(size.y, Dimension::length),
               text_of(size.z, Dimension::length),
               text_of(samples->coldest, Dimension::temperature),
               text_of(samples->hottest, Dimension::temperature),
               text_of(samples->mean_temperature, Dimension::temperature),
               text_of(samples->densest, Dimension::absorption));
  for (const VdbInfo& file : samples->files) {
    for (const GridInfo& grid : file.grids)
      text += tr("\nGrid %1: %2 voxels of %3, %4 to %5 %6")
                  .arg(QString::fromStdString(grid.name))
                  .arg(grid.active_voxels)
                  .arg(text_of(grid.voxel_size, Dimension::length))
                  .arg(grid.minimum, 0, 'g', 4)
                  .arg(grid.maximum, 0, 'g', 4)
                  .arg(QString::fromStdString(grid.unit));
    for (const std::string& remark : file.remarks) text += "\n! " + QString::fromStdString(remark);
  }
  summary_->setText(text);
  look_->set_flame_range(samples->span[0], samples->span[1]);
  look_->set_histogram(samples->coldest, samples->hottest, shares_by_temperature(*samples));
  // Share of the absorbing volume by temperature.
  PlotWidget::Series series;
  series.colour = QColor(213, 94, 0);
  constexpr int kBins = 60;
  std::array<double, kBins> counts{};
  double total = 0;
  const double range = samples->hottest - samples->coldest;
  series.bar_width = range > 0 ? range / kBins : 1;
  for (std::size_t i = 0; i < samples->temperature.size(); ++i) {
    if (samples->absorption[i] <= 0) continue;
    const double t =
        range > 0 ? (static_cast<double>(samples->temperature[i]) - samples->coldest) / range : 0.5;
    counts[static_cast<std::size_t>(std::min(kBins - 1.0, t * kBins))] += 1;
    total += 1;
  }
  for (int i = 0; i < kBins; ++i)
    if (counts[static_cast<std::size_t>(i)] > 0)
      series.points << QPointF(samples->coldest + (i + 0.5) / kBins * range,
                               100 * counts[static_cast<std::size_t>(i)] / total);
  histogram_->set_axes(tr("temperature [K]"), tr("% of volume"), false, false);
  histogram_->set_series({series});
  show_slice();
}

void FlamePanel::show_slice() {
  const auto samples = sampler_.samples();
  if (!samples || samples->temperature.empty()) return;
  const bool temperature = quantity_->currentIndex() == 0;
  const int axis = axis_->currentIndex();
  const double share = position_->value() / 100.0;
  auto image = std::make_shared<const Image>(samples->slice(axis, share, temperature));
  ToneSettings tone;
  tone.scale = ToneScale::linear;
  tone.map = temperature ? ColourMap::inferno : ColourMap::viridis;
  tone.white = temperature ? samples->hottest : samples->densest;
  if (!(tone.white > 0)) tone.white = 1;
  slice_->set_value_format(temperature ? Dimension::temperature : Dimension::absorption);
  slice_->set_tone(tone);
  slice_->set_image(std::make_shared<const ImagePyramid>(image, Execution{1, {}, {}, {}}));
  const auto at = samples->place(share, share, share);
  place_->setText(tr("%1 = %2").arg(
      QString("xyz"[axis]), text_of(at[static_cast<std::size_t>(axis)], Dimension::length)));
}

}  // namespace plenoflame::desktop
