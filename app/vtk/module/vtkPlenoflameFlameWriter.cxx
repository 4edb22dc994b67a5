#include "vtkPlenoflameFlameWriter.h"

#include <vtkImageData.h>
#include <vtkObjectFactory.h>

#include "flame_image.h"
#include "pipeline_run.h"
#include "plenoflame/base/error.h"

vtkStandardNewMacro(vtkPlenoflameFlameWriter);

vtkPlenoflameFlameWriter::vtkPlenoflameFlameWriter() {
  this->SetNumberOfOutputPorts(0);
}

vtkPlenoflameFlameWriter::~vtkPlenoflameFlameWriter() {
  this->SetFileName(nullptr);
}

void vtkPlenoflameFlameWriter::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FileName: " << (this->FileName ? this->FileName : "(none)") << "\n"
     << indent << "TemperatureArray: " << this->TemperatureArray << "\n"
     << indent << "AbsorptionArray: " << this->AbsorptionArray << "\n"
     << indent << "AmbientTemperature: " << this->AmbientTemperature << "\n"
     << indent << "Half: " << this->Half << "\n";
}

bool vtkPlenoflameFlameWriter::Write() {
  using namespace plenoflame;
  vtkImageData* image = nullptr;
  if (!plenoflame::pipeline::run_here(*this, [&] {
        vtkAlgorithm* const source = this->GetInputAlgorithm(0, 0);
        if (!source) throw UsageError("there is no flame to write: set an input");
        source->Update();
        image = vtkImageData::SafeDownCast(this->GetInputDataObject(0, 0));
        if (!image || image->GetNumberOfPoints() == 0)
          throw UsageError("the input gave no image to write");
      }))
    return false;
  return plenoflame::pipeline::run(*this, 1, [&](const Execution& execution) {
    const FlameFields flame =
        pipeline::image_to_flame(*image, this->TemperatureArray, this->AbsorptionArray,
                                 this->AmbientTemperature, execution.stop);
    GridWriteOptions options;
    options.half = this->Half;
    options.stop = execution.stop;
    write_flame(this->FileName ? this->FileName : "", flame, options);
  });
}
