#include "vtkPlenoflameCameraSource.h"

#include <vtkCompositeDataSet.h>
#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkObjectFactory.h>
#include <vtkPolyData.h>

#include <algorithm>

#include "array_geometry.h"
#include "lens_geometry.h"
#include "pipeline_run.h"
#include "plenoflame/base/error.h"
#include "plenoflame/scene/scene.h"
#include "plenoflame/scene/validate.h"
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
    plenoflame::validate(plenoflame::SceneDocument{scene->GetScene(), {}});
    const plenoflame::Camera camera(scene->GetScene().camera);
    const plenoflame::pipeline::Tessellation lens{this->LensResolution,
                                                  std::max(2, this->LensResolution / 6)};
    const plenoflame::pipeline::Tessellation microlens{this->MicrolensResolution,
                                                       std::max(1, this->MicrolensResolution / 4)};
    auto microlenses = vtkSmartPointer<vtkPolyData>::New();
    auto plate = vtkSmartPointer<vtkPolyData>::New();
    this->PlateTexture->Initialize();
    if (camera.has_array()) {
      const bool in_window = this->LevelOfDetail == WINDOW;
      if (in_window && (this->Window[2] < 1 || this->Window[3] < 1))
        throw plenoflame::UsageError("the window for microlenses is empty: set Window");
      const plenoflame::PixelWindow window =
          in_window ? plenoflame::PixelWindow{this->Window[0], this->Window[1], this->Window[2],
                                              this->Window[3]}
                    : plenoflame::PixelWindow{};
      const auto lenses = plenoflame::pipeline::microlenses_over(camera, window);
      const bool few = static_cast<int>(lenses.size()) <= this->MaximumNumberOfMicrolenses;
      const bool single = this->LevelOfDetail == ALL_MICROLENSES || in_window ||
                          (this->LevelOfDetail == AUTOMATIC && few);
      if (single) microlenses = plenoflame::pipeline::microlens_surfaces(camera, lenses, microlens);
      if (!single || in_window) {
        plate = plenoflame::pipeline::array_plate(camera);
        this->PlateTexture->ShallowCopy(plenoflame::pipeline::array_texture(camera));
      }
    }
    const auto set = [&](unsigned block, vtkPolyData* data, const char* name) {
      out->SetBlock(block, data);
      out->GetMetaData(block)->Set(vtkCompositeDataSet::NAME(), name);
    };
    set(LENS_SURFACES, plenoflame::pipeline::lens_surfaces(camera, lens), "lens surfaces");
    set(LENS_EDGES, plenoflame::pipeline::lens_edges(camera, lens), "lens edges");
    set(STOP, plenoflame::pipeline::stop_ring(camera, lens), "stop");
    set(MICROLENSES, microlenses, "microlenses");
    set(ARRAY_PLATE, plate, "array plate");
    set(SENSOR, plenoflame::pipeline::sensor_rectangle(camera), "sensor");
  });
}
