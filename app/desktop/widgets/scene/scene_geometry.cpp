#include "widgets/scene/scene_geometry.h"

#include <vtkBoundingBox.h>
#include <vtkCamera.h>
#include <vtkFloatArray.h>
#include <vtkMath.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkRenderer.h>

#include <algorithm>
#include <utility>

#include "picture_camera.h"
#include "plenoflame/scene/glass_indices.h"
#include "scene_props.h"
#include "vtkPlenoflameCameraSource.h"
#include "vtkPlenoflameScene.h"
#include "widgets/scene/camera_body.h"
#include "window_props.h"

namespace plenoflame::desktop {
namespace {

ThingSeen thing_in(const double* bounds, bool flat = false) {
  std::array<double, 6> box{};
  std::copy_n(bounds, box.size(), box.begin());
  return {views::corners(box), flat};
}

}  // namespace

SceneGeometry::SceneGeometry(Scene scene, const std::vector<CameraSpec>& others) {
  add(scene);
  for (const CameraSpec& other : others) {
    scene.camera = other;
    set_indices(scene);
    add(scene);
  }
}

void SceneGeometry::add(const Scene& scene) {
  using Source = vtkPlenoflameCameraSource;
  vtkNew<vtkPlenoflameScene> holder;
  holder->SetScene(scene);
  vtkNew<Source> source;
  source->SetInputDataObject(holder);
  source->SetLevelOfDetail(Source::PLATE);
  source->Update();
  const Camera camera(scene.camera);
  const auto parts = vtkSmartPointer<vtkMultiBlockDataSet>::New();
  parts->ShallowCopy(source->GetOutput());
  const vtkSmartPointer<vtkPolyData> plate =
      vtkPolyData::SafeDownCast(parts->GetBlock(Source::ARRAY_PLATE));
  parts->SetBlock(Source::ARRAY_PLATE, nullptr);
  const auto texture = vtkSmartPointer<vtkImageData>::New();
  texture->DeepCopy(source->GetPlateTexture());
  drawn.push_back(
      {camera, parts, plate, texture, {housing_of(camera, true), housing_of(camera, false)}});
  cameras.emplace_back(camera);
}

void SceneGeometry::add_surroundings(const Scene& scene) {
  windows = views::window_outlines(scene);
  vtkBoundingBox around;
  for (const CameraOnAxis& each : cameras)
    around.AddPoint(each.position.x, each.position.y, each.position.z);
  if (flame) around.AddBounds(flame->GetBounds());
  solids = views::solid_surfaces(scene, around);
}

std::vector<ThingSeen> SceneGeometry::things() const {
  std::vector<ThingSeen> things;
  if (flame) things.push_back(thing_in(flame->GetBounds()));
  for (const views::SolidSurfaces::Part& part : solids.parts)
    things.push_back(thing_in(part.data->GetBounds(), part.flat));
  for (const std::vector<Vec3>& outline : windows) things.push_back({outline, false});
  return things;
}

vtkSmartPointer<vtkMultiBlockDataSet> placed(vtkMultiBlockDataSet& camera,
                                             const Schematic& schematic) {
  if (schematic.is_to_scale()) return &camera;
  auto drawn = vtkSmartPointer<vtkMultiBlockDataSet>::New();
  drawn->ShallowCopy(&camera);
  for (unsigned block = 0; block < camera.GetNumberOfBlocks(); ++block) {
    auto* const data = vtkPolyData::SafeDownCast(camera.GetBlock(block));
    if (data && data->GetNumberOfPoints() > 0) drawn->SetBlock(block, placed(data, schematic));
  }
  return drawn;
}

vtkSmartPointer<vtkPolyData> placed(vtkPolyData* data, const Schematic& schematic) {
  if (schematic.is_to_scale()) return data;
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(data->GetNumberOfPoints());
  for (vtkIdType i = 0; i < data->GetNumberOfPoints(); ++i) {
    std::array<double, 3> p{};
    data->GetPoint(i, p.data());
    const Vec3 at = schematic.place({p[0], p[1], p[2]});
    points->SetPoint(i, at.x, at.y, at.z);
  }
  auto moved = vtkSmartPointer<vtkPolyData>::New();
  moved->ShallowCopy(data);
  moved->SetPoints(points);
  return moved;
}

vtkSmartPointer<vtkImageData> small_flame() {
  constexpr int kPoints = 4;
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(kPoints, kPoints, kPoints);
  image->SetSpacing(0.03, 0.03, 0.03);
  for (const auto& [name, value] : {std::pair("temperature", 1500.0F), {"absorption", 10.0F}}) {
    vtkNew<vtkFloatArray> values;
    values->SetName(name);
    values->SetNumberOfValues(image->GetNumberOfPoints());
    values->FillValue(value);
    image->GetPointData()->AddArray(values);
  }
  return image;
}

vtkSmartPointer<vtkImageData> picture_on_sensor(const ImagePyramid& light) {
  constexpr int kLargest = 640;  ///< pixels along the longer side
  const Image& image = light.level(light.level_within(kLargest));
  vtkNew<vtkImageData> rows_upwards;
  rows_upwards->SetDimensions(image.width, image.height, 1);
  vtkNew<vtkFloatArray> flux;
  flux->SetNumberOfValues(static_cast<vtkIdType>(image.pixels.size()));
  for (int row = 0; row < image.height; ++row)
    for (int column = 0; column < image.width; ++column)
      flux->SetValue(static_cast<vtkIdType>(image.height - 1 - row) * image.width + column,
                     image.at(column, row));
  rows_upwards->GetPointData()->SetScalars(flux);
  return views::picture_of(*rows_upwards);
}

void fit_clipping(vtkRenderer& renderer) {
  vtkCamera* const camera = renderer.GetActiveCamera();
  const double near = 0.02 * camera->GetDistance();
  double far = 2e4 * near;
  std::array<double, 6> bounds{};
  renderer.ComputeVisiblePropBounds(bounds.data());
  if (vtkMath::AreBoundsInitialized(bounds.data())) {
    const double* const from = camera->GetPosition();
    const double* const way = camera->GetDirectionOfProjection();
    for (const Vec3 p : views::corners(bounds))
      far = std::max(far, 1.01 * ((p.x - from[0]) * way[0] + (p.y - from[1]) * way[1] +
                                  (p.z - from[2]) * way[2]));
  }
  camera->SetClippingRange(near, far);
}

}  // namespace plenoflame::desktop
