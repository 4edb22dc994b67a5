#include "vtkPlenoflameComparison.h"

#include <vtkImageData.h>
#include <vtkObjectFactory.h>

#include "figures_json.h"
#include "light_field_image.h"
#include "pipeline_run.h"

vtkStandardNewMacro(vtkPlenoflameComparison);

vtkPlenoflameComparison::vtkPlenoflameComparison() {
  this->SetNumberOfInputPorts(2);
  this->SetNumberOfOutputPorts(0);
}

void vtkPlenoflameComparison::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Channel: " << this->Channel << "\n"
     << indent << "FiguresAsJson: " << this->FiguresAsJson << "\n";
}

int vtkPlenoflameComparison::RequestData(vtkInformation*, vtkInformationVector** inputs,
                                         vtkInformationVector*) {
  using namespace plenoflame;
  return pipeline::run(*this, 1, [&](const Execution&) {
    const LightField a = pipeline::image_to_light_field(*vtkImageData::GetData(inputs[0]));
    const LightField reference = pipeline::image_to_light_field(*vtkImageData::GetData(inputs[1]));
    this->FiguresAsJson = comparison_json(a, reference, this->Channel);
  });
}
