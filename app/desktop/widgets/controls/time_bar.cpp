#include "widgets/controls/time_bar.h"

#include <QHBoxLayout>
#include <QLabel>
#include <QSignalBlocker>
#include <QSlider>
#include <QStyle>
#include <QToolButton>
#include <algorithm>
#include <utility>

#include "plenoflame/base/error.h"
#include "plenoflame/base/units.h"
#include "plenoflame/scene/cameras.h"

namespace plenoflame::desktop {
namespace {

constexpr int kEvenSteps = 100;    ///< of times without numbers of pictures
constexpr int kPlayInterval = 40;  ///< [ms] at which is looked whether the next may come
constexpr int kLongestStep = 500;  ///< [ms] after which a picture need not be finished

}  // namespace

TimeBar::TimeBar(Session& session, QWidget* parent)
    : QWidget(parent),
      session_(session),
      play_(new QToolButton(this)),
      slider_(new QSlider(Qt::Horizontal, this)),
      label_(new QLabel(this)) {
  setObjectName("timeBar");
  play_->setObjectName("timePlay");
  play_->setIcon(style()->standardIcon(QStyle::SP_MediaPlay));
  play_->setToolTip(tr("Shows one moment after the other; again: stays"));
  slider_->setObjectName("timeSlider");
  slider_->setToolTip(tr("The moment that is shown: flames, rays and picture are those of then"));
  label_->setObjectName("timeLabel");
  auto* layout = new QHBoxLayout(this);
  layout->setContentsMargins(6, 2, 6, 2);
  layout->addWidget(new QLabel(tr("Time"), this));
  layout->addWidget(play_);
  layout->addWidget(slider_, 1);
  layout->addWidget(label_);
  hide();
  connect(play_, &QToolButton::clicked, this, [this] { play(!is_playing()); });
  connect(slider_, &QSlider::valueChanged, this, &TimeBar::choose);
  connect(&timer_, &QTimer::timeout, this, &TimeBar::advance);
  connect(&session_.document(), &Document::scene_changed, this,
          [this](const SceneChanges& changes) {
            if (!changes.time) follow();
            show_time();
          });
  // The next moment is prepared while this one is shown.
  connect(&session_.compiler(), &SceneCompiler::compiled_changed, this, [this] {
    if (timeline_ && slider_->value() < slider_->maximum())
      session_.compiler().prepare(time_of(slider_->value() + 1));
  });
  connect(&session_.compiler(), &SceneCompiler::failed, this, [this] { play(false); });
}

void TimeBar::follow() {
  const Document& document = session_.document();
  const bool changes =
      !document.is_empty() && document.is_valid() && changes_with_time(document.scene());
  setVisible(changes);
  const QSignalBlocker quiet(slider_);
  timeline_ = nullptr;
  if (!changes) return play(false);
  try {
    timeline_ = std::make_unique<SceneTimeline>(document.scene_of_camera());
  } catch (const Error&) {  // the compiler says it
  }
  slider_->setEnabled(timeline_ != nullptr);
  play_->setEnabled(timeline_ != nullptr);
  if (!timeline_) return play(false);
  if (has_frames())
    slider_->setRange(timeline_->first_frame(), timeline_->last_frame());
  else
    slider_->setRange(0, kEvenSteps);
  slider_->setPageStep(std::max(1, (slider_->maximum() - slider_->minimum()) / 10));
  slider_->setValue(!document.time() ? slider_->minimum()
                    : has_frames()   ? timeline_->frame_at(*document.time())
                                     : slider_->value());
}

double TimeBar::time_of(int step) const {
  if (has_frames()) return timeline_->begin_of(step);
  const double first = timeline_->first_time(), end = timeline_->end_time();
  return first + (end - first) * step / kEvenSteps;
}

void TimeBar::show_time() {
  if (!timeline_) return label_->clear();
  const auto text = [](double time) {
    return QString::fromStdString(readable_quantity(time, Dimension::time, 4));
  };
  const int step = slider_->value();
  const QString time = text(session_.document().time().value_or(time_of(step)));
  label_->setText(has_frames()
                      ? tr("%1, picture %2 of %3 to %4")
                            .arg(time)
                            .arg(step)
                            .arg(slider_->minimum())
                            .arg(slider_->maximum())
                      : tr("%1 of %2 to %3")
                            .arg(time, text(timeline_->first_time()), text(timeline_->end_time())));
}

void TimeBar::choose(int step) {
  if (!timeline_) return;
  since_.start();
  session_.document().choose_time(time_of(step));
  show_time();
}

void TimeBar::play(bool on) {
  if (on && timeline_) {
    since_.start();
    timer_.start(kPlayInterval);
  } else {
    timer_.stop();
  }
  play_->setIcon(
      style()->standardIcon(is_playing() ? QStyle::SP_MediaPause : QStyle::SP_MediaPlay));
}

void TimeBar::advance() {
  const bool compiled = session_.compiler().is_current();
  const bool wanted = session_.auto_render();
  const bool seen = !wanted || session_.document().image_is_current();
  const bool done = session_.render().state() != RenderJob::State::running;
  if (!compiled || !seen || !(done || since_.elapsed() > kLongestStep)) return;
  slider_->setValue(slider_->value() < slider_->maximum() ? slider_->value() + 1
                                                          : slider_->minimum());
}

}  // namespace plenoflame::desktop
