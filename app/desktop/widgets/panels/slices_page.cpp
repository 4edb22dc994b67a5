#include "widgets/panels/slices_page.h"

#include <QComboBox>
#include <QGridLayout>
#include <QLabel>
#include <QSignalBlocker>
#include <QSlider>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>

#include "slice_values.h"
#include "widgets/image/axes_frame.h"
#include "widgets/image/colour_bar.h"
#include "widgets/image/image_view.h"

namespace plenoflame::desktop {
namespace {

using Field = ReconstructFields::Field;

const QString kDeviation = "_deviation";

const Field* field_named(const ReconstructFields& fields, const std::string& name) {
  const auto found =
      std::ranges::find_if(fields.fields, [&](const Field& f) { return f.name == name; });
  return found == fields.fields.end() ? nullptr : &*found;
}

AxesFrame::Axis axis_of(const VoxelPlace& place, std::size_t k) {
  const SliceAxis axis = slice_axis(place.origin, place.direction[k], place.spacing[k],
                                    static_cast<double>(place.size[k]));
  return {QString::fromStdString(axis.label), axis.first, axis.last};
}

/// Lengths in the picture are those of the scene in both directions: voxels may be oblong.
/// @param width, height of a voxel
Image to_scale(const Image& voxels, double width, double height) {
  constexpr double kFiner = 4;  // pixels along the short side of a voxel
  if (voxels.empty() || std::fabs(width / height - 1) < 0.01) return voxels;
  const double pixel = std::min(width, height) / kFiner;
  const auto pixels = [&](int count, double length) {
    return std::max(1, static_cast<int>(std::lround(count * length / pixel)));
  };
  Image image(pixels(voxels.width, width), pixels(voxels.height, height));
  for (int row = 0; row < image.height; ++row)
    for (int column = 0; column < image.width; ++column)
      image.at(column, row) =
          voxels.at(column * voxels.width / image.width, row * voxels.height / image.height);
  return image;
}

}  // namespace

SlicesPage::SlicesPage(QWidget* parent) : QWidget(parent) {
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->addLayout(make_choices());
  found_ = make_slice("reconstructFound", tr("what is found"));
  found_.title->setObjectName("reconstructFoundTitle");
  truth_ = make_slice("reconstructTruth", tr("the flame of the scene"));
  deviation_ = make_slice("reconstructDeviation", tr("how well it is known"));
  difference_ = make_slice("reconstructDifference", tr("what is found, minus the truth"));
  auto* grid = new QGridLayout;
  int number = 0;
  for (const Slice* slice : {&found_, &truth_, &deviation_, &difference_}) {
    const int row = 2 * (number / 2), column = 2 * (number % 2);
    grid->addWidget(slice->title, row, column, 1, 2);
    grid->addWidget(slice->frame, row + 1, column);
    grid->addWidget(slice->bar, row + 1, column + 1);
    grid->setColumnStretch(column, 1);
    grid->setRowStretch(row + 1, 1);
    ++number;
  }
  layout->addLayout(grid, 1);
}

QLayout* SlicesPage::make_choices() {
  const auto choice = [this](const char* name, const QString& tip, const QStringList& entries) {
    auto* box = new QComboBox(this);
    box->setObjectName(name);
    box->setToolTip(tip);
    box->addItems(entries);
    box->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    box->setMinimumContentsLength(8);
    connect(box, QOverload<int>::of(&QComboBox::currentIndexChanged), this,
            &SlicesPage::show_slices);
    return box;
  };
  field_ = choice("reconstructField", tr("What the slices show"), {});
  axis_ = choice("reconstructAxis", tr("Plane of the slices, across an axis of the grid"),
                 {tr("across x"), tr("across y"), tr("across z")});
  position_ = new QSlider(Qt::Horizontal, this);
  position_->setObjectName("reconstructPosition");
  position_->setRange(0, 100);
  position_->setValue(50);
  position_->setToolTip(tr("Where the slices are cut"));
  connect(position_, &QSlider::valueChanged, this, &SlicesPage::show_slices);
  auto* cut = new QHBoxLayout;
  cut->addWidget(field_, 2);
  cut->addWidget(axis_, 1);
  cut->addWidget(position_, 2);
  return cut;
}

SlicesPage::Slice SlicesPage::make_slice(const char* name, const QString& empty) {
  Slice slice{new QLabel(this), new AxesFrame(name, this), new ColourBar(this)};
  // A long title must not make its slice wider than the other one.
  slice.title->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);
  slice.frame->view().set_empty_text(empty);
  return slice;
}

void SlicesPage::set_fields(std::shared_ptr<const ReconstructFields> fields, bool finished) {
  fields_ = std::move(fields);
  finished_ = finished;
  const QString before = field_->currentText();
  QStringList names, present;
  if (fields_)
    for (const Field& field : fields_->fields) {
      const QString name = QString::fromStdString(field.name);
      if (!name.endsWith(kDeviation)) names << name;
    }
  for (int i = 0; i < field_->count(); ++i) present << field_->itemText(i);
  if (names != present) {
    const QSignalBlocker quiet(field_);
    field_->clear();
    field_->addItems(names);
    const int wanted = names.indexOf(names.contains(before) ? before : "emission");
    field_->setCurrentIndex(std::max(0, wanted));
  }
  show_slices();
}

void SlicesPage::show_slices() {
  const QString name = field_->currentText();
  const Field* const field = fields_ ? field_named(*fields_, name.toStdString()) : nullptr;
  const std::vector<float> none;
  if (!field) {
    for (Slice* slice : {&found_, &truth_, &deviation_, &difference_})
      show_slice(*slice, none, 1, false);
    return;
  }
  const Field* const deviation = field_named(*fields_, (name + kDeviation).toStdString());
  const std::vector<float> errors = errors_of(field->found, field->truth);
  const Field* const emission = field_named(*fields_, "emission");
  const std::vector<float>& light = emission ? emission->found : none;
  const double reach = std::max(size_where_lit(deviation ? deviation->found : none, light),
                                size_where_lit(errors, light));
  const QString unit = QString::fromStdString(field->unit);
  const auto titled = [&](const QString& what) {
    return unit.isEmpty() ? what : what + " [" + unit + "]";
  };
  found_.title->setText(tr("found: %1").arg(titled(name)));
  truth_.title->setText(titled(tr("in the scene")));
  deviation_.title->setText(titled(tr("its deviation")));
  difference_.title->setText(titled(tr("found - scene")));
  truth_.frame->view().set_empty_text(finished_ ? tr("not known of %1").arg(name)
                                                : tr("the flame of the scene"));
  deviation_.frame->view().set_empty_text(finished_ ? tr("not known of %1").arg(name)
                                                    : tr("how well it is known"));
  show_slice(found_, field->found, field->largest, false);
  show_slice(truth_, field->truth, field->largest, false);
  show_slice(deviation_, deviation ? deviation->found : none, reach, false);
  show_slice(difference_, errors, reach, true);
}

void SlicesPage::show_slice(Slice& slice, const std::vector<float>& values, double white,
                            bool is_signed) {
  ImageView& view = slice.frame->view();
  Image image;
  const int axis = axis_->currentIndex();
  const std::size_t across = axis == 0 ? 1 : 0, up = axis == 2 ? 1 : 2;
  if (!values.empty())
    image = to_scale(fields_->slice(values, axis, position_->value() / 100.0),
                     fields_->place.spacing[across], fields_->place.spacing[up]);
  slice.bar->setVisible(!image.empty());
  if (image.empty()) {
    slice.frame->set_axes({}, {});
    return view.set_image(nullptr);
  }
  ToneSettings tone;
  tone.scale = ToneScale::linear;
  tone.map = is_signed ? ColourMap::diverging : ColourMap::inferno;
  tone.is_signed = is_signed;
  tone.white = white > 0 ? white : 1;
  view.set_tone(tone);
  slice.bar->set_tone(tone, Dimension::none);
  view.set_image(std::make_shared<const ImagePyramid>(
      std::make_shared<const Image>(std::move(image)), Execution{1, {}, {}, {}}));
  slice.frame->set_axes(axis_of(fields_->place, across), axis_of(fields_->place, up));
}

}  // namespace plenoflame::desktop
