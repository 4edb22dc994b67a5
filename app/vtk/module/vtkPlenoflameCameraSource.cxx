#include "vtkPlenoflameCameraSource.h"

#include <vtkCompositeDataSet.h>
#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkObjectFactory.h>
#include <vtkPolyData.h>

#include "array_geometry.h"
#include "pipeline_run.h"
#include "plenoflame/scene/scene.h"
#include "scene_algorithm.h"
#include "vtkPlenoflameScene.h"

vtkStandardNewMacro(vtkPlenoflameCameraSource);

vtkPlenoflameCameraSource::vtkPlenoflameCameraSource() {
  this->SetNumberOfInputPorts(1);
}

vtkPlenoflameCameraSource::~vtkPlenoflameCameraSource() = default;

void vtkPlenoflameCameraSource::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "LevelOfDetail: " << this->LevelOfDetail << "\n"
     << indent << "MaximumNumberOfMicrolenses: " << this->MaximumNumberOfMicrolenses << "\n"
     << indent << "Window: " << this->Window[0] << " " << this->Window[1] << " " << this->Window[2]
     << " " << this->Window[3] << "\n"
     << indent << "LensResolution: " << this->LensResolution << "\n"
     << indent << "MicrolensResolution: " << this->MicrolensResolution << "\n";
}

vtkImageData* vtkPlenoflameCameraSource::GetPlateTexture() {
  return this->PlateTexture;
}

void vtkPlenoflameCameraSource::GetTypeColor(int type, double rgb[3]) {
  const plenoflame::Vec3 colour = plenoflame::pipeline::type_colour(type);
  rgb[0] = colour.x;
  rgb[1] = colour.y;
  rgb[2] = colour.z;
}

int vtkPlenoflameCameraSource::FillInputPortInformation(int, vtkInformation* information) {
  plenoflame::pipeline::want_scene(*information);
  return 1;
}

int vtkPlenoflameCameraSource::RequestData(vtkInformation*, vtkInformationVector** inputs,
                                           vtkInformationVector* outputs) {
  vtkPlenoflameScene* const scene = plenoflame::pipeline::scene_of(inputs);
  auto* const out = vtkMultiBlockDataSet::GetData(outputs, 0);
  return plenoflame::pipeline::run_here(*this, [&] {
    using plenoflame::ArrayDetail;
    const plenoflame::Scene one = scene->GetSceneOfCamera();
    plenoflame::CameraMeshRequest request;
    request.detail = this->LevelOfDetail == WINDOW            ? ArrayDetail::window
                     : this->LevelOfDetail == ALL_MICROLENSES ? ArrayDetail::all
                     : this->LevelOfDetail == AUTOMATIC       ? ArrayDetail::automatic
                                                              : ArrayDetail::plate;
    request.most_microlenses = static_cast<std::size_t>(this->MaximumNumberOfMicrolenses);
    request.window = {this->Window[0], this->Window[1], this->Window[2], this->Window[3]};
    request.lens_sectors = this->LensResolution;
    request.microlens_sectors = this->MicrolensResolution;
    const plenoflame::CameraMeshes meshes = plenoflame::camera_meshes(one, request);
    this->PlateTexture->Initialize();
    if (meshes.plate.polygons() > 0)
      this->PlateTexture->ShallowCopy(
          plenoflame::pipeline::array_texture(plenoflame::Camera(one.camera)));
    const auto set = [&](unsigned block, const plenoflame::CameraMesh& mesh, const char* name) {
      out->SetBlock(block, plenoflame::pipeline::polydata_of(mesh));
      out->GetMetaData(block)->Set(vtkCompositeDataSet::NAME(), name);
    };
    set(LENS_SURFACES, meshes.lens_surfaces, "lens surfaces");
    set(LENS_EDGES, meshes.lens_edges, "lens edges");
    set(STOP, meshes.stop, "stop");
    set(MICROLENSES, meshes.microlenses, "microlenses");
    set(ARRAY_PLATE, meshes.plate, "array plate");
    set(SENSOR, meshes.sensor, "sensor");
  });
}
