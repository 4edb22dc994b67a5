#pragma once
#include <QWidget>

#include "model/session.h"

class QCheckBox;
class QLabel;
class QProgressBar;
class QPushButton;

namespace plenoflame::desktop {

class PlotWidget;

/// "1.5 s", "12 s", "2.0 min"; a dash for what is not known (below 0).
QString duration_text(double seconds);

/// Progress of the image, and its commands: pause, resume, stop, repeat, refine.
class RenderPanel : public QWidget {
  Q_OBJECT
 public:
  explicit RenderPanel(Session& session, QWidget* parent = nullptr);
  /// Error, time and speed in one line, of a picture that is made or was made; empty: of none.
  QString brief() const;

 signals:
  void failed(const QString& message);

 private:
  void show_status();
  void multiply_samples(double factor);

  Session& session_;
  PlotWidget* curve_;
  QProgressBar* bar_;
  QPushButton *start_, *pause_, *stop_, *finer_, *coarser_;
  QCheckBox* automatic_;
  QLabel *state_, *error_, *rays_, *time_, *skipped_;
};

}  // namespace plenoflame::desktop
