#pragma once
#include <QVTKOpenGLNativeWidget.h>
#include <vtkCallbackCommand.h>
#include <vtkDistanceWidget.h>
#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkHandleWidget.h>
#include <vtkInteractorStyleTrackballCamera.h>
#include <vtkNew.h>
#include <vtkOrientationMarkerWidget.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkProp.h>
#include <vtkPropCollection.h>
#include <vtkRenderStepsPass.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include <QElapsedTimer>
#include <QTimer>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "widgets/image/scale_bar.h"
#include "widgets/scene/eye_layer.h"
#include "widgets/scene/lens_detail.h"
#include "widgets/scene/scene_labels.h"
#include "widgets/scene/scene_view.h"

class vtkImageData;

namespace plenoflame::desktop {

/// Temperatures between which nearly all of the emission of a drawn flame lies [K]; on any thread.
std::array<double, 2> span_of(vtkImageData& flame);

/// The parts of VTK that the 3-D view is made of; known to its own sources only.
struct SceneView::View {
  QVTKOpenGLNativeWidget* widget = nullptr;
  vtkNew<vtkGenericOpenGLRenderWindow> window;
  vtkNew<vtkRenderer> renderer;
  vtkNew<vtkInteractorStyleTrackballCamera> style;
  vtkNew<vtkCallbackCommand> before_drawing;
  vtkNew<vtkCallbackCommand> turning;   ///< begins and ends
  vtkNew<vtkRenderStepsPass> in_order;  ///< draws glass as it comes
  QTimer rest;                          ///< after turns of the wheel: then glass is sorted
  vtkNew<vtkDistanceWidget> ruler;
  vtkNew<vtkCallbackCommand> ruler_moved;
  vtkNew<vtkOrientationMarkerWidget> axes;
  std::unique_ptr<ScaleBar> scale_bar;
  std::unique_ptr<EyeLayer> eye;  ///< the flames as eyes see them
  SceneLabels labels;             ///< of the layer "gaps"
  /// Something of the scene that is dragged by the pointer.
  struct Handle {
    vtkSmartPointer<vtkHandleWidget> widget;
    int flame = -1;  ///< its number; -1: the camera
    Vec3 offset;     ///< [m] from the position in the scene's file to the handle
  };
  std::vector<Handle> handles;
  /// The way of light along a ray as it is drawn, and how far its points are from the beginning.
  struct Way {
    std::vector<Vec3> points;
    std::vector<double> lengths;
  };
  std::vector<Way> ways;
  vtkNew<vtkPolyData> light;
  vtkSmartPointer<vtkProp> light_points;
  QElapsedTimer light_since;
  vtkNew<vtkCallbackCommand> moved_elsewhere;  ///< of a camera that two views share
  std::map<std::string, std::vector<vtkSmartPointer<vtkProp>>> layers;
  std::vector<ArrayPart> arrays;                 ///< whose microlenses are drawn one by one
  std::vector<vtkSmartPointer<vtkProp>> hidden;  ///< of the layers, until their turn comes

  void add_axes_cube();
  /// Glass before glass is sorted at rest alone. Without a graphics card this takes longer than all
  /// else, and even VTK's mean of unsorted glass takes a quarter of the time.
  void sort_glass(bool on) {
    rest.stop();
    renderer->SetUseDepthPeeling(on);
    renderer->SetPass(on ? nullptr : in_order.GetPointer());
  }
  void place_labels();
  /// Axes and scale bar, which an empty view has none of.
  void show_frame(bool on) {
    if ((axes->GetEnabled() != 0) != on) axes->SetEnabled(on ? 1 : 0);
    scale_bar->set_visible(on);
  }
  /// Replaces what the layer shows by what add(renderer) adds.
  template <class Add>
  void replace(const std::string& layer, Add add) {
    for (const auto& prop : layers[layer]) renderer->RemoveViewProp(prop);
    layers[layer].clear();
    const int before = renderer->GetViewProps()->GetNumberOfItems();
    add(*renderer);
    vtkPropCollection* const props = renderer->GetViewProps();
    for (int i = before; i < props->GetNumberOfItems(); ++i)
      layers[layer].push_back(vtkProp::SafeDownCast(props->GetItemAsObject(i)));
  }
  void show(const std::string& layer, bool on) {
    for (const auto& prop : layers[layer]) prop->SetVisibility(on);
  }
};

}  // namespace plenoflame::desktop
