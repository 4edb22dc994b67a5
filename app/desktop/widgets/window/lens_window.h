#pragma once
#include <QDialog>
#include <array>
#include <vector>

#include "model/jobs/lens_job.h"

class QLabel;
class QTableWidget;

namespace plenoflame::desktop {

class PlotWidget;

/// The main lens's surfaces as lens designers list them: radius, thickness, glass, semi-diameter,
/// which can be typed, with focal length and f-number live.
class LensTable : public QDialog {
  Q_OBJECT
 public:
  explicit LensTable(Document& document, QWidget* parent = nullptr);

 signals:
  void failed(const QString& message);

 private:
  void fill();
  void take(int row, int column);
  Document& document_;
  QTableWidget* table_;
  QLabel* figures_;
  bool filling_ = false;
};

/// Diagrams of the main lens: spots, ray fans or contrast, on the axis, at 0.7 of the field and at
/// its edge.
class LensDiagrams : public QDialog {
  Q_OBJECT
 public:
  enum class Kind { spots, fans, contrast };
  LensDiagrams(Kind kind, LensJob& job, QWidget* parent = nullptr);
  const std::array<PlotWidget*, 3>& plots() const { return plots_; }

 private:
  void show_result();
  void show_spots(const LensDesign& design);
  void show_fans(const LensDesign& design);
  void show_contrast(const LensDesign& design);
  Kind kind_;
  LensJob& job_;
  std::array<QLabel*, 3> titles_{};
  std::array<PlotWidget*, 3> plots_{};
};

}  // namespace plenoflame::desktop
