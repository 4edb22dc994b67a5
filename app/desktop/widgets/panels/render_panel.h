#pragma once
#include <QWidget>

#include "model/session.h"

class QCheckBox;
class QLabel;
class QProgressBar;
class QPushButton;

namespace plenoflame::desktop {

class PlotWidget;

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
