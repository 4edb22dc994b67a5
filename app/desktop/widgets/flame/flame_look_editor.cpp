#include "widgets/flame/flame_look_editor.h"

#include <QCheckBox>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QPushButton>
#include <QSignalBlocker>
#include <QSlider>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "widgets/flame/opacity_curve.h"

namespace plenoflame::desktop {
namespace {

constexpr std::array<ColourMap, 3> kMaps{ColourMap::inferno, ColourMap::viridis,
                                         ColourMap::cividis};
constexpr double kStepsPerOctave = 5;  ///< of the slider of density

}  // namespace

FlameLookEditor::FlameLookEditor(Document& document, QWidget* parent)
    : QWidget(parent), document_(document) {
  map_ = new QComboBox(this);
  map_->setObjectName("flameColours");
  map_->addItems({tr("Inferno"), tr("Viridis"), tr("Cividis")});
  map_->setToolTip(tr("Colours of temperature in the 3-D view"));
  cold_ = new QDoubleSpinBox(this);
  hot_ = new QDoubleSpinBox(this);
  cold_->setObjectName("flameCold");
  hot_->setObjectName("flameHot");
  for (QDoubleSpinBox* box : {cold_, hot_}) {
    box->setRange(0, 20000);
    box->setDecimals(0);
    box->setSingleStep(50);
    box->setSuffix(" K");
    box->setKeyboardTracking(false);
  }
  cold_->setToolTip(tr("Temperature of the first colour [K]"));
  hot_->setToolTip(tr("Temperature of the last colour [K]"));
  automatic_ = new QCheckBox(tr("Auto"), this);
  automatic_->setObjectName("flameAutomatic");
  automatic_->setToolTip(tr("First and last colour from the flame itself"));
  density_ = new QSlider(Qt::Horizontal, this);
  density_->setObjectName("flameDensity");
  density_->setRange(-20, 20);
  density_->setToolTip(
      tr("How dense the flame looks in 3-D; the light field does not depend on it"));
  auto* reset = new QPushButton(tr("Reset"), this);
  reset->setObjectName("flameLookReset");
  reset->setToolTip(tr("Colours, density and opacity as they were at first"));
  curve_ = new OpacityCurve(this);
  curve_->setObjectName("flameOpacity");

  auto* ends = new QHBoxLayout;
  ends->addWidget(cold_, 1);
  ends->addWidget(hot_, 1);
  auto* colours = new QHBoxLayout;
  colours->addWidget(map_, 1);
  colours->addWidget(automatic_);
  auto* density = new QHBoxLayout;
  density->addWidget(density_, 1);
  density->addWidget(reset);
  auto* form = new QFormLayout(this);
  form->setContentsMargins(0, 0, 0, 0);
  // On two lines: side by side the fields would cut off their units in a narrow panel.
  form->addRow(tr("3-D colours"), colours);
  form->addRow(tr("from, to"), ends);
  form->addRow(tr("Density"), density);
  form->addRow(tr("Opacity"), curve_);

  const auto edit = [this](const QString& what, auto change, const std::string& merge = {}) {
    FlameLook look = document_.look();
    change(look);
    document_.set_look(look, what.toStdString(), merge);
  };
  connect(map_, QOverload<int>::of(&QComboBox::currentIndexChanged), this, [edit](int index) {
    edit(tr("colours of the flame"),
         [&](FlameLook& look) { look.map = kMaps[static_cast<std::size_t>(std::max(0, index))]; });
  });
  connect(density_, &QSlider::valueChanged, this, [edit](int value) {
    edit(
        tr("density of the flame"),
        [&](FlameLook& look) { look.density = std::pow(2.0, value / kStepsPerOctave); },
        "look.density");
  });
  for (QDoubleSpinBox* box : {cold_, hot_})
    connect(box, QOverload<double>::of(&QDoubleSpinBox::valueChanged), this,
            &FlameLookEditor::edit_ends);
  connect(automatic_, &QCheckBox::toggled, this, &FlameLookEditor::edit_ends);
  connect(reset, &QPushButton::clicked, this,
          [edit] { edit(tr("look of the flame"), [](FlameLook& look) { look = {}; }); });
  connect(curve_, &OpacityCurve::edited, this,
          [edit](const std::vector<OpacityPoint>& points, int stroke) {
            edit(
                tr("opacity of the flame"), [&](FlameLook& look) { look.points = points; },
                "look.opacity " + std::to_string(stroke));
          });
  connect(&document_, &Document::look_changed, this, &FlameLookEditor::show_look);
  show_look();
}

void FlameLookEditor::edit_ends() {
  FlameLook look = document_.look();
  // A typed temperature replaces the automatic one; ticking the box restores the flame's own.
  look.automatic = sender() == automatic_ && automatic_->isChecked();
  look.cold = look.automatic ? 0 : cold_->value();
  look.hot = look.automatic ? 0 : hot_->value();
  if (!look.automatic && !(look.hot > look.cold)) return show_look();
  document_.set_look(look, tr("temperatures of the colours").toStdString(), "look.ends");
}

void FlameLookEditor::set_flame_range(double coldest, double hottest) {
  coldest_ = coldest;
  hottest_ = hottest;
  show_look();
}

void FlameLookEditor::set_histogram(double coldest, double hottest, std::vector<double> shares) {
  curve_->set_histogram(coldest, hottest, std::move(shares));
}

void FlameLookEditor::show_look() {
  const FlameLook& look = document_.look();
  const QSignalBlocker a(map_), b(cold_), c(hot_), d(automatic_), e(density_);
  const auto map = std::find(kMaps.begin(), kMaps.end(), look.map);
  map_->setCurrentIndex(map == kMaps.end() ? 0 : static_cast<int>(map - kMaps.begin()));
  const double cold = look.automatic ? coldest_ : look.cold,
               hot = look.automatic ? hottest_ : look.hot;
  cold_->setValue(cold);
  hot_->setValue(hot);
  automatic_->setChecked(look.automatic);
  density_->setValue(static_cast<int>(std::lround(kStepsPerOctave * std::log2(look.density))));
  curve_->set_look(look);
  curve_->set_range(cold, hot);
}

}  // namespace plenoflame::desktop
