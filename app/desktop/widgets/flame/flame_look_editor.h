#pragma once
#include <QWidget>
#include <vector>

#include "model/document.h"

class QCheckBox;
class QComboBox;
class QDoubleSpinBox;
class QSlider;

namespace plenoflame::desktop {

class OpacityCurve;

/// Editor of the flame's look in 3-D: colours, their temperatures, density, opacity over
/// temperature. Every change is a step that can be undone.
class FlameLookEditor : public QWidget {
  Q_OBJECT
 public:
  explicit FlameLookEditor(Document& document, QWidget* parent = nullptr);
  /// Temperatures that the flame has where it absorbs [K].
  void set_flame_range(double coldest, double hottest);
  /// The histogram behind the curve of opacity, see OpacityCurve.
  void set_histogram(double coldest, double hottest, std::vector<double> shares);

 private:
  void show_look();
  void edit_ends();

  Document& document_;
  QComboBox* map_;
  QDoubleSpinBox *cold_, *hot_;
  QCheckBox* automatic_;
  QSlider* density_;
  OpacityCurve* curve_;
  double coldest_ = 0, hottest_ = 0;
};

}  // namespace plenoflame::desktop
