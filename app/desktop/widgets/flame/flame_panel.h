#pragma once
#include <QWidget>

#include "model/document.h"
#include "model/jobs/flame_sampler.h"

class QComboBox;
class QLabel;
class QSlider;

namespace plenoflame::desktop {

class FlameLookEditor;
class ImageView;
class PlotWidget;

/// The flame: what its grids hold, slices, histogram, how it is drawn; generators and files.
class FlamePanel : public QWidget {
  Q_OBJECT
 public:
  FlamePanel(Document& document, SceneCompiler& compiler, QWidget* parent = nullptr);
  FlameSampler& sampler() { return sampler_; }

 signals:
  void generate_requested();
  void import_requested();
  /// The user wants to say what each grid of the flame's file is. @param flame number in the scene
  void mapping_requested(int flame);

 private:
  void fill();
  void show_slice();

  Document& document_;
  FlameSampler sampler_;
  QLabel *summary_, *place_;
  ImageView* slice_;
  PlotWidget* histogram_;
  FlameLookEditor* look_;
  QComboBox *axis_, *quantity_;
  QSlider* position_;
};

}  // namespace plenoflame::desktop
