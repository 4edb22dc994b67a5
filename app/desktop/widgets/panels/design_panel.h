#pragma once
#include <QString>
#include <QWidget>
#include <array>
#include <vector>

#include "model/jobs/design_job.h"

class QLabel;
class QTableWidget;
class QToolButton;

namespace plenoflame::desktop {

class PlotWidget;

/// The design report, live: figures, warnings, effective resolution against
/// distance.
class DesignPanel : public QWidget {
  Q_OBJECT
 public:
  explicit DesignPanel(DesignJob& job, QWidget* parent = nullptr);

 protected:
  bool eventFilter(QObject* object, QEvent* event) override;

 private:
  void fill();
  void fit_columns();
  void show_fold();

  DesignJob& job_;
  QTableWidget* table_;
  QToolButton* fold_;
  QLabel* warnings_;
  PlotWidget* resolution_;
  int shown_count_ = 0;
  std::vector<std::array<QString, 3>> rows_;  ///< figure, value, remark
};

}  // namespace plenoflame::desktop
