#include "widgets/panels/render_panel.h"

#include <QCheckBox>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QProgressBar>
#include <QPushButton>
#include <QStringList>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>

#include "plenoflame/base/error.h"
#include "widgets/controls/flow_layout.h"
#include "widgets/controls/plot_widget.h"

namespace plenoflame::desktop {

QString duration_text(double seconds) {
  if (seconds < 0) return QString::fromUtf8("\xe2\x80\x93");
  if (seconds < 100) return QObject::tr("%1 s").arg(seconds, 0, 'f', seconds < 10 ? 1 : 0);
  return QObject::tr("%1 min").arg(seconds / 60, 0, 'f', 1);
}

RenderPanel::RenderPanel(Session& session, QWidget* parent) : QWidget(parent), session_(session) {
  const auto button = [this](const QString& text, const char* name, const QString& tip) {
    auto* b = new QPushButton(text, this);
    b->setObjectName(name);
    b->setToolTip(tip);
    return b;
  };
  start_ = button(tr("Render"), "renderStart", tr("Render the scene from the beginning (F5)"));
  pause_ = button(tr("Pause"), "renderPause", tr("Keep what is there and go on later (F6)"));
  stop_ = button(tr("Stop"), "renderStop", tr("End; the picture stays (Shift+F5)"));
  finer_ = button(tr("4x samples"), "renderFiner",
                  tr("Four times the rays per pixel: half the error or less"));
  coarser_ = button(tr("1/4"), "renderCoarser", tr("A quarter of the rays per pixel"));
  automatic_ = new QCheckBox(tr("Follow changes"), this);
  automatic_->setObjectName("renderAutomatic");
  automatic_->setToolTip(
      tr("Render again by itself whenever a parameter changes what the camera sees"));
  automatic_->setChecked(session_.auto_render());
  bar_ = new QProgressBar(this);
  bar_->setRange(0, 1000);
  bar_->setTextVisible(true);
  const auto value = [this](const QString& tip) {
    auto* label = new QLabel(this);
    label->setToolTip(tip);
    label->setTextInteractionFlags(Qt::TextSelectableByMouse);
    label->setWordWrap(true);  // a long one must not make the panel wider than its place
    label->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);
    return label;
  };
  state_ = value(tr("What is going on; samples: rays per pixel and microlens"));
  error_ = value(tr("Estimated relative root mean square error over lit pixels"));
  rays_ = value(tr("Rays traced per second, and in this pass"));
  time_ = value(tr("Time spent, and time that remains for all passes"));
  skipped_ = value(tr("What did not need to be computed in the last pass"));
  skipped_->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Minimum);
  skipped_->setMinimumHeight(2 * fontMetrics().lineSpacing());  // nothing moves when it fills
  skipped_->setObjectName("renderLeftOut");
  error_->setObjectName("renderError");
  state_->setObjectName("renderState");
  rays_->setObjectName("renderRays");
  time_->setObjectName("renderTime");
  curve_ = new PlotWidget(this);
  curve_->setObjectName("renderCurve");
  curve_->set_axes(tr("time [s]"), tr("relative RMSE"), true, true);
  curve_->setMinimumHeight(80);
  curve_->set_empty_text(tr("Error against time appears while an image is rendered."));
  auto* buttons = new FlowLayout;  // in a small window they take two lines
  buttons->setContentsMargins(0, 0, 0, 0);
  for (QPushButton* b : {start_, pause_, stop_, finer_, coarser_}) buttons->addWidget(b);
  auto* form = new QFormLayout;
  form->addRow(tr("State"), state_);
  form->addRow(tr("Error"), error_);
  form->addRow(tr("Rays"), rays_);
  form->addRow(tr("Time"), time_);
  auto* second = new QHBoxLayout;
  second->addWidget(automatic_);
  second->addWidget(bar_, 1);
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(6, 4, 6, 4);
  layout->addLayout(buttons);
  layout->addLayout(second);
  layout->addLayout(form);
  layout->addWidget(curve_, 1);
  layout->addWidget(skipped_);

  RenderJob& job = session_.render();
  connect(&job, &RenderJob::state_changed, this, &RenderPanel::show_status);
  connect(&job, &RenderJob::progressed, this, &RenderPanel::show_status);
  connect(&session_.document(), &Document::state_changed, this, &RenderPanel::show_status);
  connect(start_, &QPushButton::clicked, this, [this] { session_.start_render(); });
  connect(pause_, &QPushButton::clicked, this, [this] {
    if (session_.render().state() == RenderJob::State::paused)
      session_.render().resume();
    else
      session_.render().pause();
  });
  connect(stop_, &QPushButton::clicked, this, [this] { session_.render().stop(); });
  connect(finer_, &QPushButton::clicked, this, [this] { multiply_samples(4); });
  connect(coarser_, &QPushButton::clicked, this, [this] { multiply_samples(0.25); });
  connect(automatic_, &QCheckBox::toggled, this, [this](bool on) { session_.set_auto_render(on); });
  show_status();
}

void RenderPanel::multiply_samples(double factor) {
  Document& document = session_.document();
  if (document.is_empty()) return;
  const int most =
      document.scene().render.estimator == Estimator::forward ? kMostBundles : kMostSamples;
  const double wanted = std::clamp(std::round(document.scene().render.samples * factor), 1.0,
                                   static_cast<double>(most));
  try {
    document.set_value("render.samples", std::to_string(static_cast<int>(wanted)), {});
  } catch (const Error& error) {
    emit failed(QString::fromUtf8(error.what()));
  }
}

QString RenderPanel::brief() const {
  const RenderJob& job = session_.render();
  const RenderJob::Status& status = job.status();
  QStringList parts;
  if (status.relative_error >= 0)
    parts << tr("error %1 %").arg(100 * status.relative_error, 0, 'g', 2);
  if (job.state() == RenderJob::State::running && status.remaining_seconds >= 0)
    parts << tr("%1 to go").arg(duration_text(status.remaining_seconds));
  else if (status.seconds > 0)
    parts << duration_text(status.seconds);
  if (status.rays_per_second > 0)
    parts << tr("%1 million rays/s").arg(status.rays_per_second / 1e6, 0, 'f', 1);
  return parts.join(QString::fromUtf8(" \xc2\xb7 "));
}

void RenderPanel::show_status() {
  const RenderJob& job = session_.render();
  const RenderJob::Status& status = job.status();
  using State = RenderJob::State;
  const bool running = job.state() == State::running, paused = job.state() == State::paused;
  for (QPushButton* const button : {start_, finer_, coarser_})
    button->setEnabled(!session_.document().is_empty());
  pause_->setEnabled(running || paused);
  pause_->setText(paused ? tr("Resume") : tr("Pause"));
  stop_->setEnabled(running || paused);
  QString text;
  switch (job.state()) {
    case State::idle:
      text = tr("idle");
      break;
    case State::running:
      text =
          tr("pass %1 of %2, %3 samples").arg(status.pass).arg(status.passes).arg(status.samples);
      break;
    case State::paused:
      text = tr("paused in pass %1 of %2").arg(status.pass).arg(status.passes);
      break;
    case State::finished:
      text = tr("finished, %1 samples").arg(session_.document().scene().render.samples);
      break;
    case State::failed:
      text = tr("failed");
      break;
  }
  state_->setText(text);
  error_->setText(status.relative_error >= 0
                      ? tr("%1 %").arg(100 * status.relative_error, 0, 'g', 3)
                      : QString::fromUtf8("\xe2\x80\x93"));
  rays_->setText(status.rays > 0 ? tr("%1 million per second, %2 million in this pass")
                                       .arg(status.rays_per_second / 1e6, 0, 'f', 1)
                                       .arg(status.rays / 1e6, 0, 'f', 1)
                                 : QString::fromUtf8("\xe2\x80\x93"));
  time_->setText(
      running ? tr("%1, %2 to go")
                    .arg(duration_text(status.seconds), duration_text(status.remaining_seconds))
              : duration_text(status.seconds));
  const RenderStatistics& s = job.statistics();
  const auto share = [](double part, double whole) {
    return whole > 0 ? QString::number(100 * part / whole, 'f', 0) : QString("0");
  };
  QStringList left_out;
  if (s.lenses_skipped > 0)
    left_out << tr("%1 % of the microlenses").arg(share(s.lenses_skipped, s.lenses));
  if (s.tiles_skipped > 0) left_out << tr("%1 % of the tiles").arg(share(s.tiles_skipped, s.tiles));
  for (const std::string& phrase : s.left_out) left_out << QString::fromStdString(phrase);
  skipped_->setText(left_out.isEmpty() ? QString() : tr("Skipped: ") + left_out.join(", "));
  // By itself a bar draws at once, and with it the whole window, before all the rest that changes
  // here is drawn in its turn.
  bar_->setUpdatesEnabled(false);
  bar_->setValue(static_cast<int>(std::lround(1000 * status.fraction)));
  bar_->setUpdatesEnabled(true);
  PlotWidget::Series series;
  series.colour = QColor(0, 114, 178);
  series.marks = true;
  for (const RenderJob::CurvePoint& point : job.curve())
    series.points << QPointF(point.seconds, point.error);
  curve_->set_series({series});
}

}  // namespace plenoflame::desktop
