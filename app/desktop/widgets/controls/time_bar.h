#pragma once
#include <QElapsedTimer>
#include <QTimer>
#include <QWidget>
#include <memory>

#include "model/session.h"
#include "plenoflame/scene/timeline.h"

class QLabel;
class QSlider;
class QToolButton;

namespace plenoflame::desktop {

/// Moments of a scene whose flames change: a slider, its time, and a button that plays. Hidden for
/// scenes that do not change.
class TimeBar : public QWidget {
  Q_OBJECT
 public:
  explicit TimeBar(Session& session, QWidget* parent = nullptr);
  bool is_playing() const { return timer_.isActive(); }
  void play(bool on);

 private:
  void follow();
  void show_time();
  void choose(int step);
  void advance();
  /// [s] of a position of the slider.
  double time_of(int step) const;
  /// True if pictures have numbers; otherwise the slider divides the time evenly.
  bool has_frames() const { return timeline_ && timeline_->frame_rate() > 0; }

  Session& session_;
  std::unique_ptr<SceneTimeline> timeline_;
  QToolButton* play_;
  QSlider* slider_;
  QLabel* label_;
  QTimer timer_;
  QElapsedTimer since_;  ///< the present step was chosen
};

}  // namespace plenoflame::desktop
