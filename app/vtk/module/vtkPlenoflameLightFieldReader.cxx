#include "vtkPlenoflameLightFieldReader.h"

#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkObjectFactory.h>

#include "light_field_image.h"
#include "pipeline_run.h"

vtkStandardNewMacro(vtkPlenoflameLightFieldReader);

vtkPlenoflameLightFieldReader::vtkPlenoflameLightFieldReader() {
  this->SetNumberOfInputPorts(0);
}

vtkPlenoflameLightFieldReader::~vtkPlenoflameLightFieldReader() {
  this->SetFileName(nullptr);
}

void vtkPlenoflameLightFieldReader::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FileName: " << (this->FileName ? this->FileName : "(none)") << "\n";
}

int vtkPlenoflameLightFieldReader::RequestInformation(vtkInformation*, vtkInformationVector**,
                                                      vtkInformationVector* outputs) {
  return plenoflame::pipeline::run_here(*this, [&] {
    const auto field = plenoflame::read_light_field_header(this->FileName ? this->FileName : "");
    plenoflame::pipeline::announce_light_field(field.window, field.sensor_height,
                                               *outputs->GetInformationObject(0));
  });
}

int vtkPlenoflameLightFieldReader::RequestData(vtkInformation*, vtkInformationVector**,
                                               vtkInformationVector* outputs) {
  return plenoflame::pipeline::run_here(*this, [&] {
    const auto field = plenoflame::read_light_field(this->FileName ? this->FileName : "");
    plenoflame::pipeline::light_field_to_image(field, *vtkImageData::GetData(outputs));
  });
}
