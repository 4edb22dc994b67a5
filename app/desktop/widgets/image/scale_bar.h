#pragma once
#include <vtkSmartPointer.h>

#include "widgets/scene/scene_labels.h"

class vtkActor2D;
class vtkPoints;
class vtkRenderer;
class vtkTextActor;

namespace plenoflame::desktop {

/// A bar of a round length at the lower edge of a 3-D view. The length is measured in the plane
/// through the middle of the view.
class ScaleBar {
 public:
  explicit ScaleBar(vtkRenderer& renderer);
  /// To be called before each drawing.
  void update(vtkRenderer& renderer);
  void set_visible(bool on);
  double length() const { return length_; }    ///< [m]
  ScreenBox box(vtkRenderer& renderer) const;  ///< bar and text

 private:
  vtkSmartPointer<vtkPoints> points_;
  vtkSmartPointer<vtkActor2D> line_;
  vtkSmartPointer<vtkTextActor> text_;
  double length_ = 0;
};

}  // namespace plenoflame::desktop
