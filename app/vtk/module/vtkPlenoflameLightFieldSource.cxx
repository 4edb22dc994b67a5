#include "vtkPlenoflameLightFieldSource.h"

#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkObjectFactory.h>

#include <algorithm>

#include "light_field_image.h"
#include "pipeline_run.h"
#include "plenoflame/base/error.h"
#include "plenoflame/render/describe.h"
#include "plenoflame/render/ground_truth.h"
#include "plenoflame/render/render_request.h"
#include "scene_algorithm.h"
#include "vtkPlenoflameScene.h"

vtkStandardNewMacro(vtkPlenoflameLightFieldSource);

vtkPlenoflameLightFieldSource::vtkPlenoflameLightFieldSource() {
  this->SetNumberOfInputPorts(1);
}

vtkPlenoflameLightFieldSource::~vtkPlenoflameLightFieldSource() = default;

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
     << indent << "Truth: " << this->Truth << "\n"
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
  plenoflame::SensorSpec sensor;
  if (!plenoflame::pipeline::run_here(*this,
                                      [&] { sensor = scene->GetSceneOfCamera().camera.sensor; }))
    return 0;
  plenoflame::PixelWindow window{0, 0, std::max(1, sensor.columns), std::max(1, sensor.rows)};
  const int rows = window.height;
  if (this->Window[2] > 0)
    window = {this->Window[0], this->Window[1], this->Window[2], this->Window[3]};
  plenoflame::pipeline::announce_light_field(window, rows, *outputs->GetInformationObject(0));
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
        plenoflame::RenderRequest request;
        if (this->Estimator == BACKWARD) request.estimator = plenoflame::Estimator::backward;
        if (this->Estimator == FORWARD) request.estimator = plenoflame::Estimator::forward;
        if (this->Samples > 0) request.samples = this->Samples;
        if (this->TargetError > 0) request.target_error = this->TargetError;
        if (this->TimeLimit > 0) request.time_limit = this->TimeLimit;
        if (this->Seed >= 0) request.seed = static_cast<std::uint64_t>(this->Seed);
        plenoflame::RenderSettings settings = plenoflame::render_settings(compiled->scene, request);
        if (this->Window[2] != 0)  // render() checks it
          settings.window = {this->Window[0], this->Window[1], this->Window[2], this->Window[3]};
        settings.standard_error = this->StandardError;
        plenoflame::RenderResult result = plenoflame::render(*compiled, settings, execution);
        plenoflame::describe(*compiled, result.light_field);
        if (this->Truth) {
          plenoflame::Execution rest = execution;
          rest.stop = {};  // a run that was stopped is kept, too
          plenoflame::add_ground_truth(*compiled, result.light_field, rest);
        }
        this->Complete = result.statistics.complete;
        this->RelativeError = result.statistics.relative_error;
        this->NumberOfRays = result.statistics.rays;
        plenoflame::pipeline::light_field_to_image(result.light_field, *image);
      });
}
