#pragma once
#include <QWidget>

#include "model/document.h"
#include "model/flame_sampler.h"
#include "widgets/scene_view.h"

class QComboBox;
class QDoubleSpinBox;
class QLabel;
class QSlider;

namespace plenoflame::desktop {

class ImageView;
class PlotWidget;

/// The flame: what its grids hold, slices, histogram, how it is drawn; generators and files.
class FlamePanel : public QWidget {
  Q_OBJECT
 public:
  FlamePanel(Document& document, SceneCompiler& compiler, QWidget* parent = nullptr);
  FlameSampler& sampler() { return sampler_; }

 signals:
  void look_changed(const plenoflame::desktop::FlameLook& look);
  void generate_requested();
  void import_requested();
  /// Which grids of the flame's file are what. @param flame number in the scene
  void mapping_requested(int flame);

 private:
  void fill();
  void show_slice();
  void emit_look();

  Document& document_;
  FlameSampler sampler_;
  QLabel *summary_, *place_;
  ImageView* slice_;
  PlotWidget* histogram_;
  QComboBox *axis_, *quantity_, *map_;
  QSlider *position_, *opacity_;
  QDoubleSpinBox *cold_, *hot_;
  bool automatic_ = true;
};

}  // namespace plenoflame::desktop
