#include "vtkPlenoflameLightFieldSource.h"

#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkObjectFactory.h>
#include <vtkStreamingDemandDrivenPipeline.h>

#include <algorithm>
#include <array>

#include "light_field_image.h"
#include "pipeline_run.h"
#include "plenoflame/base/error.h"
#include "plenoflame/render/describe.h"
#include "plenoflame/render/render.h"
#include "scene_algorithm.h"
#include "vtkPlenoflameScene.h"

vtkStandardNewMacro(vtkPlenoflameLightFieldSource);

vtkPlenoflameLightFieldSource::vtkPlenoflameLightFieldSource() {
  this->SetNumberOfInputPorts(1);
}

void vtkPlenoflameLightFieldSource::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Samples: " << this->Samples << "\n"
     << indent << "Seed: " << this->Seed << "\n"
     << indent << "Estimator: " << this->Estimator << "\n"
     << indent << "TargetError: " << this->TargetError << "\n"
     << indent << "TimeLimit: " << this->TimeLimit << "\n"
     << indent << "Window: " << this->Window[0] << " " << this->Window[1] << " " << this->Window[2]
     << " " << this->Window[3] << "\n"
     << indent << "NumberOfThreads: " << this->NumberOfThreads << "\n"
     << indent << "StandardError: " << this->StandardError << "\n"
     << indent << "Complete: " << this->Complete << "\n"
     << indent << "RelativeError: " << this->RelativeError << "\n"
     << indent << "NumberOfRays: " << this->NumberOfRays << "\n";
}

int vtkPlenoflameLightFieldSource::FillInputPortInformation(int, vtkInformation* information) {
  plenoflame::pipeline::want_scene(*information);
  return 1;
}

int vtkPlenoflameLightFieldSource::RequestInformation(vtkInformation*,
                                                      vtkInformationVector** inputs,
                                                      vtkInformationVector* outputs) {
  vtkPlenoflameScene* const scene = plenoflame::pipeline::scene_of(inputs);
  const auto& sensor = scene->GetScene().camera.sensor;
  const int width = this->Window[2] > 0 ? this->Window[2] : std::max(1, sensor.columns);
  const int height = this->Window[2] > 0 ? this->Window[3] : std::max(1, sensor.rows);
  const std::array<int, 6> extent{0, width - 1, 0, height - 1, 0, 0};
  outputs->GetInformationObject(0)->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(),
                                        extent.data(), 6);
  return 1;
}

int vtkPlenoflameLightFieldSource::RequestUpdateExtent(vtkInformation*, vtkInformationVector**,
                                                       vtkInformationVector*) {
  return 1;  // a scene has no extent
}

int vtkPlenoflameLightFieldSource::RequestData(vtkInformation*, vtkInformationVector** inputs,
                                               vtkInformationVector* outputs) {
  vtkPlenoflameScene* const scene = plenoflame::pipeline::scene_of(inputs);
  vtkImageData* const image = vtkImageData::GetData(outputs);
  return plenoflame::pipeline::run(
      *this, this->NumberOfThreads, [&](const plenoflame::Execution& execution) {
        const auto compiled = scene->Compile(execution);
        const plenoflame::RenderSpec& spec = compiled->scene.render;
        plenoflame::RenderSettings settings;
        settings.estimator = this->Estimator == BACKWARD  ? plenoflame::Estimator::backward
                             : this->Estimator == FORWARD ? plenoflame::Estimator::forward
                                                          : spec.estimator;
        settings.target_error = this->TargetError;
        settings.time_limit = this->TimeLimit;
        const bool open_ended = this->TargetError > 0 || this->TimeLimit > 0;
        const bool forward = settings.estimator == plenoflame::Estimator::forward;
        // A scene made for the other estimator says nothing about the number of bundles.
        const bool scene_says = spec.estimator == settings.estimator;
        if (this->Samples > 0)
          settings.samples = this->Samples;
        else if (open_ended)
          settings.samples = forward ? plenoflame::kMostBundles : plenoflame::kMostSamples;
        else if (forward && !(scene_says && spec.samples != plenoflame::RenderSpec{}.samples))
          settings.samples = plenoflame::kForwardSamples;
        else
          settings.samples = spec.samples;
        settings.replicates = std::clamp(
            settings.samples, 1, forward ? plenoflame::kForwardReplicates : settings.replicates);
        settings.seed = this->Seed >= 0 ? static_cast<std::uint64_t>(this->Seed) : spec.seed;
        if (this->Window[2] != 0)  // render() checks it
          settings.window = {this->Window[0], this->Window[1], this->Window[2], this->Window[3]};
        settings.standard_error = this->StandardError;
        plenoflame::RenderResult result = plenoflame::render(*compiled, settings, execution);
        plenoflame::describe(*compiled, result.light_field);
        this->Complete = result.statistics.complete;
        this->RelativeError = result.statistics.relative_error;
        this->NumberOfRays = result.statistics.rays;
        plenoflame::pipeline::light_field_to_image(result.light_field, *image);
      });
}
