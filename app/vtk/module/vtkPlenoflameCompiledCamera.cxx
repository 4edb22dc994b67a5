#include "vtkPlenoflameCompiledCamera.h"

#include <vtkObjectFactory.h>
#include <vtkSmartPointer.h>

#include <algorithm>

#include "figures_json.h"
#include "pipeline_run.h"
#include "plenoflame/base/error.h"
#include "plenoflame/render/compiled_camera.h"
#include "vtkPlenoflameScene.h"

namespace pipeline = plenoflame::pipeline;

struct vtkPlenoflameCompiledCamera::Internals {
  vtkSmartPointer<vtkPlenoflameScene> Scene;
  std::shared_ptr<const plenoflame::CompiledCamera> Rays;
};

vtkStandardNewMacro(vtkPlenoflameCompiledCamera);

vtkPlenoflameCompiledCamera::vtkPlenoflameCompiledCamera()
    : Internal(std::make_unique<Internals>()) {
  this->SetNumberOfInputPorts(0);
  this->SetNumberOfOutputPorts(0);
}

vtkPlenoflameCompiledCamera::~vtkPlenoflameCompiledCamera() = default;

void vtkPlenoflameCompiledCamera::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Error: " << this->Error << "\n"
     << indent << "Samples: " << this->Samples << "\n"
     << indent << "Level: " << this->Level << "\n"
     << indent << "Seed: " << this->Seed << "\n"
     << indent << "Window: " << this->Window[0] << " " << this->Window[1] << " " << this->Window[2]
     << " " << this->Window[3] << "\n"
     << indent << "Region: " << this->Region[0] << " " << this->Region[1] << " " << this->Region[2]
     << " to " << this->Region[3] << " " << this->Region[4] << " " << this->Region[5] << "\n"
     << indent << "Margin: " << this->Margin << "\n"
     << indent << "NumberOfThreads: " << this->NumberOfThreads << "\n"
     << indent << "Rays: " << (this->Internal->Rays ? this->Internal->Rays->nodes : 0) << "\n";
}

void vtkPlenoflameCompiledCamera::SetScene(vtkPlenoflameScene* scene) {
  this->Internal->Scene = scene;
  this->Modified();
}

int vtkPlenoflameCompiledCamera::RequestData(vtkInformation*, vtkInformationVector**,
                                             vtkInformationVector*) {
  using namespace plenoflame;
  Internals& in = *this->Internal;
  in.Rays.reset();
  const bool ended = pipeline::run(*this, this->NumberOfThreads, [&](const Execution& execution) {
    if (!in.Scene) throw UsageError("a compiled camera needs a scene");
    CompileSettings settings;
    settings.error = this->Error;
    settings.samples = this->Samples;
    settings.level = this->Level;
    settings.seed = static_cast<std::uint64_t>(std::max<vtkTypeInt64>(0, this->Seed));
    settings.margin = this->Margin;
    const int* const w = this->Window;
    if (w[2] > 0) settings.window = {w[0], w[1], w[2], w[3]};
    const double* const r = this->Region;
    if (std::any_of(r, r + 6, [](double x) { return x != 0; }))
      settings.region = {{r[0], r[1], r[2]}, {r[3], r[4], r[5]}};
    in.Rays = std::make_shared<const CompiledCamera>(
        compile_camera(*in.Scene->Compile(execution), settings, execution));
  });
  return ended || this->GetAbortExecute() ? 1 : 0;
}

bool vtkPlenoflameCompiledCamera::Read(const std::string& path) {
  return pipeline::run_here(*this, [&] {
    this->Internal->Rays =
        std::make_shared<const plenoflame::CompiledCamera>(plenoflame::read_bundle(path));
  });
}

bool vtkPlenoflameCompiledCamera::Write(const std::string& path) {
  return pipeline::run_here(*this, [&] {
    if (!this->Internal->Rays) throw plenoflame::UsageError("there are no rays yet: call Update()");
    plenoflame::write_bundle(path, *this->Internal->Rays);
  });
}

std::string vtkPlenoflameCompiledCamera::GetFiguresAsJson() {
  return this->Internal->Rays ? plenoflame::compiled_camera_json(*this->Internal->Rays) : "";
}

std::shared_ptr<const plenoflame::CompiledCamera> vtkPlenoflameCompiledCamera::GetRays() const {
  return this->Internal->Rays;
}
