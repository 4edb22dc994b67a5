#include "vtkPlenoflameFlameSource.h"

#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkPointData.h>
#include <vtkStreamingDemandDrivenPipeline.h>

#include <algorithm>
#include <array>
#include <cmath>

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
  const std::array<int, 6> extent{0, 0, 0, 0, 0, 0};
  outputs->GetInformationObject(0)->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(),
                                        extent.data(), 6);
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
    const plenoflame::Medium& medium = *compiled->medium;
    const plenoflame::Box box = medium.bounds();
    const plenoflame::Vec3 size = box.upper - box.lower;
    const std::array<double, 3> sides{size.x, size.y, size.z};
    const double step = *std::max_element(sides.begin(), sides.end()) / (this->Resolution - 1);
    std::array<int, 3> points{};
    for (std::size_t k = 0; k < 3; ++k)
      points[k] = std::max(2, static_cast<int>(std::ceil(sides[k] / step - 1e-9)) + 1);
    image->Initialize();
    image->SetDimensions(points.data());
    image->SetSpacing(step, step, step);
    // Centred: what the last step reaches beyond the bounds is shared by both ends.
    const auto start = [&](std::size_t k, double low) {
      return low - 0.5 * (step * (points[k] - 1) - sides[k]);
    };
    const plenoflame::Vec3 origin{start(0, box.lower.x), start(1, box.lower.y),
                                  start(2, box.lower.z)};
    image->SetOrigin(origin.x, origin.y, origin.z);
    vtkNew<vtkFloatArray> temperature, absorption;
    temperature->SetName("temperature");
    absorption->SetName("absorption");
    temperature->SetNumberOfValues(image->GetNumberOfPoints());
    absorption->SetNumberOfValues(image->GetNumberOfPoints());
    plenoflame::parallel_for(
        execution, static_cast<std::size_t>(points[2]), [&](std::size_t k, int) {
          vtkIdType at = static_cast<vtkIdType>(k) * points[0] * points[1];
          for (int j = 0; j < points[1]; ++j)
            for (int i = 0; i < points[0]; ++i, ++at) {
              const plenoflame::MediumSample sample = medium.sample(
                  origin + step * plenoflame::Vec3{static_cast<double>(i), static_cast<double>(j),
                                                   static_cast<double>(k)});
              temperature->SetValue(at, static_cast<float>(sample.temperature));
              absorption->SetValue(at, static_cast<float>(sample.absorption));
            }
        });
    image->GetPointData()->AddArray(absorption);
    image->GetPointData()->SetScalars(temperature);
  });
}
