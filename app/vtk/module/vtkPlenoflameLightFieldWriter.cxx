#include "vtkPlenoflameLightFieldWriter.h"

#include <vtkImageData.h>
#include <vtkObjectFactory.h>

#include "light_field_image.h"
#include "pipeline_run.h"
#include "plenoflame/base/error.h"

vtkStandardNewMacro(vtkPlenoflameLightFieldWriter);

vtkPlenoflameLightFieldWriter::vtkPlenoflameLightFieldWriter() {
  this->SetNumberOfOutputPorts(0);
}

vtkPlenoflameLightFieldWriter::~vtkPlenoflameLightFieldWriter() {
  this->SetFileName(nullptr);
}

void vtkPlenoflameLightFieldWriter::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FileName: " << (this->FileName ? this->FileName : "(none)") << "\n";
}

bool vtkPlenoflameLightFieldWriter::Write() {
  return plenoflame::pipeline::run_here(*this, [&] {
    vtkAlgorithm* const source = this->GetInputAlgorithm(0, 0);
    if (!source) throw plenoflame::UsageError("there is no light field to write: set an input");
    source->Update();
    auto* const image = vtkImageData::SafeDownCast(this->GetInputDataObject(0, 0));
    if (!image) throw plenoflame::UsageError("the input gave no image to write");
    plenoflame::write_light_field(this->FileName ? this->FileName : "",
                                  plenoflame::pipeline::image_to_light_field(*image));
  });
}
