#include "vtkPlenoflameRayPathSource.h"

#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkObjectFactory.h>
#include <vtkPolyData.h>

#include <vector>

#include "pipeline_run.h"
#include "plenoflame/render/ray_path_request.h"
#include "ray_path_data.h"
#include "scene_algorithm.h"
#include "vtkPlenoflameScene.h"

struct vtkPlenoflameRayPathSource::Internals {
  std::vector<plenoflame::Pixel> Pixels;
  std::vector<plenoflame::LensIndex> Microlenses;
  std::vector<plenoflame::Vec3> ObjectPoints;
};

vtkStandardNewMacro(vtkPlenoflameRayPathSource);

vtkPlenoflameRayPathSource::vtkPlenoflameRayPathSource() : Internal(std::make_unique<Internals>()) {
  this->SetNumberOfInputPorts(1);
}

vtkPlenoflameRayPathSource::~vtkPlenoflameRayPathSource() = default;

void vtkPlenoflameRayPathSource::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Pixels: " << this->Internal->Pixels.size() << "\n"
     << indent << "Microlenses: " << this->Internal->Microlenses.size() << "\n"
     << indent << "ObjectPoints: " << this->Internal->ObjectPoints.size() << "\n"
     << indent << "NumberOfRandomPixels: " << this->NumberOfRandomPixels << "\n"
     << indent << "ChiefRays: " << this->ChiefRays << "\n"
     << indent << "RaysPerPixel: " << this->RaysPerPixel << "\n"
     << indent << "RaysPerPoint: " << this->RaysPerPoint << "\n"
     << indent << "FlameSamples: " << this->FlameSamples << "\n"
     << indent << "Seed: " << this->Seed << "\n"
     << indent << "StatusSelected: " << this->StatusSelected[0] << " " << this->StatusSelected[1]
     << " " << this->StatusSelected[2] << " " << this->StatusSelected[3] << "\n"
     << indent << "SelectedType: " << this->SelectedType << "\n"
     << indent << "MaximumNumberOfRays: " << this->MaximumNumberOfRays << "\n"
     << indent << "NumberOfThreads: " << this->NumberOfThreads << "\n";
}

void vtkPlenoflameRayPathSource::AddPixel(int column, int row) {
  this->Internal->Pixels.push_back({column, row});
  this->Modified();
}

void vtkPlenoflameRayPathSource::AddMicrolens(int q, int r) {
  this->Internal->Microlenses.push_back({q, r});
  this->Modified();
}

void vtkPlenoflameRayPathSource::AddObjectPoint(double x, double y, double z) {
  this->Internal->ObjectPoints.push_back({x, y, z});
  this->Modified();
}

void vtkPlenoflameRayPathSource::RemoveAllBundles() {
  *this->Internal = {};
  this->Modified();
}

void vtkPlenoflameRayPathSource::SetStatusSelected(int status, bool selected) {
  if (status < 0 || status > 3 || this->StatusSelected[status] == selected) return;
  this->StatusSelected[status] = selected;
  this->Modified();
}

bool vtkPlenoflameRayPathSource::GetStatusSelected(int status) {
  return status >= 0 && status <= 3 && this->StatusSelected[status];
}

int vtkPlenoflameRayPathSource::FillInputPortInformation(int, vtkInformation* information) {
  plenoflame::pipeline::want_scene(*information);
  return 1;
}

int vtkPlenoflameRayPathSource::RequestUpdateExtent(vtkInformation*, vtkInformationVector**,
                                                    vtkInformationVector*) {
  return 1;
}

int vtkPlenoflameRayPathSource::RequestData(vtkInformation*, vtkInformationVector** inputs,
                                            vtkInformationVector* outputs) {
  using namespace plenoflame;
  vtkPlenoflameScene* const input = plenoflame::pipeline::scene_of(inputs);
  vtkPolyData* const out = vtkPolyData::GetData(outputs);
  return plenoflame::pipeline::run(*this, this->NumberOfThreads, [&](const Execution& execution) {
    const auto scene = input->Compile(execution);
    RayPathRequest request;
    request.pixels = this->Internal->Pixels;
    request.microlenses = this->Internal->Microlenses;
    request.points = this->Internal->ObjectPoints;
    request.random_pixels = this->NumberOfRandomPixels;
    request.chief_rays = this->ChiefRays;
    request.rays_per_pixel = this->RaysPerPixel;
    request.rays_per_point = this->RaysPerPoint;
    request.flame_samples = this->FlameSamples;
    if (this->Seed >= 0) request.seed = static_cast<std::uint64_t>(this->Seed);
    for (std::size_t status = 0; status < request.statuses.size(); ++status)
      request.statuses[status] = this->StatusSelected[status];
    request.type = this->SelectedType;
    request.most = static_cast<std::size_t>(this->MaximumNumberOfRays);
    plenoflame::pipeline::ray_paths_to_polydata(trace_ray_paths(*scene, request, execution), *out);
  });
}
