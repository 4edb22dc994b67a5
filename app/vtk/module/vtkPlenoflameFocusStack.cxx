#include "vtkPlenoflameFocusStack.h"

#include <vtkImageData.h>
#include <vtkObjectFactory.h>

#include <array>
#include <cstdio>

#include "light_field_camera.h"
#include "light_field_image.h"
#include "pipeline_run.h"
#include "plenoflame/lightfield/refocus.h"

vtkStandardNewMacro(vtkPlenoflameFocusStack);

void vtkPlenoflameFocusStack::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Depths:";
  for (const double depth : this->Depths) os << " " << depth;
  os << "\n";
}

void vtkPlenoflameFocusStack::AddDepth(double depth) {
  this->Depths.push_back(depth);
  this->Modified();
}

void vtkPlenoflameFocusStack::RemoveAllDepths() {
  this->Depths.clear();
  this->Modified();
}

int vtkPlenoflameFocusStack::RequestData(vtkInformation*, vtkInformationVector** inputs,
                                         vtkInformationVector* outputs) {
  using namespace plenoflame;
  vtkImageData* const in = vtkImageData::GetData(inputs[0]);
  vtkImageData* const out = vtkImageData::GetData(outputs);
  return pipeline::run(*this, this->NumberOfThreads, [&](const Execution& execution) {
    const LightField field = pipeline::image_to_light_field(*in);
    const TakenThrough optics = taken_through(field);
    const Camera checked(optics.camera);
    for (const double depth : this->Depths) check_refocus_depth(checked, depth);
    const FocusStack stack = focus_stack(field, this->micro_images(optics, execution), this->Depths,
                                         this->refocus_settings(), execution);
    pipeline::image_to_vtk(stack.all_in_focus, "all_in_focus", *out);
    pipeline::add_image(stack.depth, "depth", *out);
    pipeline::add_image(stack.confidence, "confidence", *out);
    std::size_t number = 0;
    for (const RefocusedImage& plane : stack.planes) {
      std::array<char, 24> name{};
      std::snprintf(name.data(), name.size(), "plane_%04zu", number++);
      pipeline::add_image(plane.image, name.data(), *out);
    }
    if (!stack.planes.empty()) this->set_geometry(stack.planes.back());
  });
}
