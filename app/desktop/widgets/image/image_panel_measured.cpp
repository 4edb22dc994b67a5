#include <QAction>
#include <QComboBox>
#include <QLabel>
#include <QToolButton>
#include <algorithm>

#include "plenoflame/lightfield/develop.h"
#include "widgets/controls/glyphs.h"
#include "widgets/controls/tool_row.h"
#include "widgets/image/image_panel.h"
#include "widgets/image/image_view.h"

// A measured picture beside the simulated one: shown in its place, laid over it, or in turns.
namespace plenoflame::desktop {
namespace {

constexpr int kBlinkInterval = 600;  ///< [ms] that each of the two is shown

}  // namespace

Dimension dimension_of(const LightField& field) {
  return field.unit == "W" ? Dimension::flux : Dimension::none;
}

void ImagePanel::make_choice_of_picture(ToolRow& tools) {
  picture_ = new QComboBox(&tools);
  picture_->setObjectName("shownPicture");
  picture_->addItems({tr("Simulated"), tr("Measured"), tr("Overlay")});
  picture_->setToolTip(
      tr("The simulated picture, the measured one, or one over the other: simulated in magenta, "
         "measured in green, grey where they agree"));
  tools.add(picture_);
  blink_ = new QAction(tr("Blink"), this);
  blink_->setObjectName("blinkPictures");
  blink_->setCheckable(true);
  blink_->setShortcut(Qt::Key_B);
  blink_->setToolTip(tr("Simulated and measured picture in turns, equally bright (B)"));
  auto* const button = button_for(blink_, &tools);
  tools.add(button);
  registration_ = new QLabel(this);
  registration_->setObjectName("registrationText");
  registration_->setWordWrap(true);
  registration_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  registration_->setContentsMargins(6, 0, 6, 2);
  registration_->hide();
  const auto show_choice = [this, button] {
    const bool there = measured_.field() != nullptr;
    picture_->setVisible(there);
    button->setVisible(there);
    blink_->setEnabled(there);
    if (!there) blink_->setChecked(false);
  };
  show_choice();
  connect(picture_, QOverload<int>::of(&QComboBox::currentIndexChanged), this,
          &ImagePanel::show_picture);
  connect(blink_, &QAction::toggled, this, [this](bool on) {
    blinked_ = false;
    on ? blinking_.start(kBlinkInterval) : blinking_.stop();
    show_picture();
  });
  connect(&blinking_, &QTimer::timeout, this, [this] {
    blinked_ = !blinked_;
    show_picture();
  });
  connect(&measured_, &MeasuredPicture::changed, this, [this, show_choice] {
    show_choice();
    picture_->setCurrentIndex(
        static_cast<int>(measured_.field() ? Picture::measured : Picture::simulated));
    request_measured();
  });
  connect(&measured_, &MeasuredPicture::renewed, this, &ImagePanel::request_measured);
  connect(&measured_, &MeasuredPicture::registration_changed, this, [this] {
    registration_->setText(measured_.registration_text());
    registration_->setVisible(!measured_.registration_text().isEmpty());
    show_picture();
  });
}

void ImagePanel::request_measured() {
  const auto field = measured_.field();
  if (!field) {
    measured_task_.cancel();
    measured_pyramid_ = nullptr;
    return show_picture();
  }
  const std::size_t channel = std::min(channel_of(*field), field->channels.size() - 1);
  measured_task_.request([this, field, channel](std::stop_token stop) {
    Execution execution;
    execution.stop = std::move(stop);
    try {
      const Image& flux = field->channels[channel].flux;
      auto pyramid = std::make_shared<const ImagePyramid>(
          std::shared_ptr<const Image>(field, &flux), execution);
      const double white = automatic_saturation(flux);
      post(this, [this, field, pyramid, white] {
        if (field != measured_.field()) return;
        measured_pyramid_ = pyramid;
        own_white_ = white > 0 ? white : 1;
        show_picture();
      });
    } catch (const std::exception&) {  // stopped: a newer request follows
    }
  });
}

ImagePanel::Picture ImagePanel::picture() const {
  if (!measured_pyramid_) return Picture::simulated;
  // An imported picture that was opened is there alone, until its scene is rendered.
  if (!pyramid_ || document_.image() == measured_.field()) return Picture::measured;
  if (blink_->isChecked()) return blinked_ ? Picture::measured : Picture::simulated;
  return static_cast<Picture>(picture_->currentIndex());
}

/// As bright as the simulated picture is where it is known by how much the two differ.
double ImagePanel::measured_white() const {
  const auto& known = measured_.registration();
  return known && known->whole.gain > 0 ? known->whole.gain * automatic_white_ : own_white_;
}

const LightField* ImagePanel::drawn_field() const {
  return picture() == Picture::measured ? measured_.field().get() : document_.image().get();
}

bool ImagePanel::shows_relative_error() const {
  return picture() == Picture::simulated &&
         static_cast<Quantity>(quantity_->currentIndex()) == Quantity::relative_error;
}

Dimension ImagePanel::dimension() const {
  if (shows_relative_error()) return Dimension::none;
  const LightField* const field = drawn_field();
  return field ? dimension_of(*field) : Dimension::flux;
}

void ImagePanel::show_picture() {
  const Picture now = picture();
  quantity_->setEnabled(now == Picture::simulated);
  view_->set_image(now == Picture::measured  ? measured_pyramid_
                   : now == Picture::overlay ? flux_pyramid_
                                             : pyramid_);
  view_->set_colours(now == Picture::simulated ? colours_ : nullptr);
  view_->set_overlay(now == Picture::overlay ? measured_pyramid_ : nullptr, measured_white());
  view_->set_caption(!measured_pyramid_          ? QString()
                     : now == Picture::simulated ? tr("simulated")
                     : now == Picture::measured  ? tr("measured: %1").arg(measured_.name())
                                                 : tr("simulated (magenta), measured (green)"));
  apply_tone();
  update_profile();
}

}  // namespace plenoflame::desktop
