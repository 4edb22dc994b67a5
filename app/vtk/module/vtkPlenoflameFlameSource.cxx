#include "vtkPlenoflameFlameSource.h"

#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkObjectFactory.h>

#include "flame_image.h"
#include "made_image.h"
#include "pipeline_run.h"
#include "plenoflame/base/error.h"
#include "plenoflame/scene/compile.h"
#include "scene_algorithm.h"
#include "vtkPlenoflameScene.h"

struct vtkPlenoflameFlameSource::Internals {
  plenoflame::pipeline::MadeImage Flame;
};

vtkStandardNewMacro(vtkPlenoflameFlameSource);

vtkPlenoflameFlameSource::vtkPlenoflameFlameSource() : Internal(std::make_unique<Internals>()) {
  this->SetNumberOfInputPorts(1);
}

vtkPlenoflameFlameSource::~vtkPlenoflameFlameSource() = default;

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
  return this->Internal->Flame.announce(*this, *outputs->GetInformationObject(0),
                                        [this](vtkImageData& image) { return this->Make(image); });
}

int vtkPlenoflameFlameSource::RequestUpdateExtent(vtkInformation*, vtkInformationVector**,
                                                  vtkInformationVector*) {
  return 1;  // a scene has no extent
}

int vtkPlenoflameFlameSource::RequestData(vtkInformation*, vtkInformationVector**,
                                          vtkInformationVector* outputs) {
  this->Internal->Flame.give(*outputs);
  return 1;
}

bool vtkPlenoflameFlameSource::Make(vtkImageData& image) {
  auto* const scene = vtkPlenoflameScene::SafeDownCast(this->GetInputDataObject(0, 0));
  return plenoflame::pipeline::run(*this, 0, [&](const plenoflame::Execution& execution) {
    const auto compiled = scene->Compile(execution);
    if (!compiled->medium) throw plenoflame::InputError("the scene has no flame");
    if (const auto sampled =
            plenoflame::pipeline::flame_image(*compiled->medium, this->Resolution, execution))
      image.ShallowCopy(sampled);
  });
}
