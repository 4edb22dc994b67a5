#pragma once
#include <QWidget>

#include "model/design_job.h"

class QLabel;
class QTableWidget;

namespace plenoflame::desktop {

class PlotWidget;

/// The design report, live: figures, warnings, effective resolution against distance.
class DesignPanel : public QWidget {
  Q_OBJECT
 public:
  explicit DesignPanel(DesignJob& job, QWidget* parent = nullptr);

 private:
  void fill();

  DesignJob& job_;
  QTableWidget* table_;
  QLabel* warnings_;
  PlotWidget* resolution_;
};

}  // namespace plenoflame::desktop
