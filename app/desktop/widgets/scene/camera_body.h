#pragma once
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include "plenoflame/camera/camera.h"

class vtkActor;
class vtkRenderer;

// The look of a camera as an object.
namespace plenoflame::desktop {

enum class Housing { none, cut_open, closed };

/// A body around main lens, array and sensor, which no scene describes: a tube that ends in a box.
/// @param half leaves away the half on the camera's left
vtkSmartPointer<vtkPolyData> housing_of(const Camera& camera, bool half);

void add_housing(vtkPolyData& housing, vtkRenderer& renderer);

/// Lets a translucent part mirror the windows of a room, more so at grazing angles.
void mirror_a_room(vtkActor& part);

}  // namespace plenoflame::desktop
