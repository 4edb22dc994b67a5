#include "vtkPlenoflameFlameSource.h"

#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkObjectFactory.h>

#include "flame_image.h"
#include "pipeline_run.h"
#include "plenoflame/base/error.h"
#include "plenoflame/scene/compile.h"
#include "scene_algorithm.h"
#include "vtkPlenoflameScene.h"

vtkStandardNewMacro(vtkPlenoflameFlameSource);

vtkPlenoflameFlameSource::vtkPlenoflameFlameSource() {
  this->SetNumberOfInputPorts(1);
}

void vtkPlenoflameFlameSource::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Resolution: " << this->Resolution << "\n";
}

int vtkPlenoflameFlameSource::FillInputPortInformation(int, vtkInformation* information) {
  plenoflame::pipeline::want_scene(*information);
  return 1;
}

int vtkPlenoflameFlameSource::RequestInformation(vtkInformation*, vtkInformationVector**,
                                                 vtkInformationVector* outputs) {
  // The flames' bounds are known when they have been loaded.
  plenoflame::pipeline::announce_image(*outputs->GetInformationObject(0));
  return 1;
}

int vtkPlenoflameFlameSource::RequestUpdateExtent(vtkInformation*, vtkInformationVector**,
                                                  vtkInformationVector*) {
  return 1;  // a scene has no extent
}

int vtkPlenoflameFlameSource::RequestData(vtkInformation*, vtkInformationVector** inputs,
                                          vtkInformationVector* outputs) {
  vtkPlenoflameScene* const scene = plenoflame::pipeline::scene_of(inputs);
  vtkImageData* const image = vtkImageData::GetData(outputs);
  return plenoflame::pipeline::run(*this, 0, [&](const plenoflame::Execution& execution) {
    const auto compiled = scene->Compile(execution);
    if (!compiled->medium) throw plenoflame::InputError("the scene has no flame");
    image->Initialize();
    if (const auto sampled =
            plenoflame::pipeline::flame_image(*compiled->medium, this->Resolution, execution))
      image->ShallowCopy(sampled);
  });
}
