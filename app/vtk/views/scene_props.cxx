#include "scene_props.h"

#include <vtkActor.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkImageData.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkNew.h>
#include <vtkOpenGLPolyDataMapper.h>
#include <vtkOpenGLVertexBufferObject.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>
#include <vtkTexture.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "vtkPlenoflameCameraSource.h"

namespace plenoflame::views {
namespace {

using Source = vtkPlenoflameCameraSource;

/// Coordinates go to the graphics library relative to the part's own middle. In its single
/// precision, the surfaces of a microlens half a metre from the origin would coincide.
vtkSmartPointer<vtkPolyDataMapper> mapper_of(vtkPolyData* data) {
  const auto mapper = vtkSmartPointer<vtkOpenGLPolyDataMapper>::New();
  mapper->SetInputData(data);
  mapper->SetVBOShiftScaleMethod(vtkOpenGLVertexBufferObject::ALWAYS_AUTO_SHIFT_SCALE);
  mapper->ScalarVisibilityOff();
  return mapper;
}

vtkSmartPointer<vtkActor> actor_of(vtkPolyData* data, const std::array<double, 3>& colour,
                                   double opacity) {
  const auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper_of(data));
  actor->GetProperty()->SetColor(colour[0], colour[1], colour[2]);
  actor->GetProperty()->SetOpacity(opacity);
  actor->GetProperty()->SetSpecular(opacity < 1 ? 1 : 0.4);  // glass mirrors the lamp
  actor->GetProperty()->SetSpecularPower(opacity < 1 ? 60 : 30);
  return actor;
}

/// A copy of `data` whose cells have the colours that `colour(i)` gives.
template <class Colour>
vtkSmartPointer<vtkPolyData> coloured(vtkPolyData* data, Colour colour) {
  const auto copy = vtkSmartPointer<vtkPolyData>::New();
  copy->ShallowCopy(data);
  vtkNew<vtkUnsignedCharArray> colours;
  colours->SetNumberOfComponents(3);
  colours->SetName("colour");
  colours->SetNumberOfTuples(data->GetNumberOfCells());
  for (vtkIdType i = 0; i < data->GetNumberOfCells(); ++i) {
    double rgb[3];
    colour(i, rgb);
    for (int k = 0; k < 3; ++k)
      colours->SetTypedComponent(i, k, static_cast<unsigned char>(std::lround(255 * rgb[k])));
  }
  copy->GetCellData()->SetScalars(colours);
  return copy;
}

/// The part of the sensor that a window of it covers.
vtkSmartPointer<vtkPolyData> window_of(vtkPolyData* sensor, vtkImageData& picture) {
  const auto part = vtkSmartPointer<vtkPolyData>::New();
  part->DeepCopy(sensor);
  vtkDataArray* const size = picture.GetFieldData()->GetArray("plenoflame.sensor");
  if (!size) return part;
  double corner[3], right[3], up[3];
  sensor->GetPoint(0, corner);
  sensor->GetPoint(1, right);
  sensor->GetPoint(3, up);
  const std::array<double, 2> whole{size->GetComponent(0, 0), size->GetComponent(1, 0)};
  const double* const origin = picture.GetOrigin();
  const int* const points = picture.GetDimensions();
  for (vtkIdType i = 0; i < 4; ++i) {
    const double* t = sensor->GetPointData()->GetTCoords()->GetTuple2(i);
    const double u = (origin[0] - 0.5 + t[0] * points[0]) / whole[0];
    const double v = (origin[1] - 0.5 + t[1] * points[1]) / whole[1];
    double at[3];
    for (int k = 0; k < 3; ++k)
      at[k] = corner[k] + u * (right[k] - corner[k]) + v * (up[k] - corner[k]);
    part->GetPoints()->SetPoint(i, at);
  }
  return part;
}

vtkSmartPointer<vtkTexture> texture_of(vtkImageData* image, bool repeat) {
  const auto texture = vtkSmartPointer<vtkTexture>::New();
  texture->SetInputData(image);
  texture->SetRepeat(repeat);
  texture->SetEdgeClamp(!repeat);
  texture->SetMipmap(repeat);
  texture->SetInterpolate(repeat);
  return texture;
}

/// A part whose sides away from the light are seen before the dark, too.
vtkSmartPointer<vtkActor> body_of(vtkPolyData* data, const std::array<double, 3>& colour,
                                  double opacity) {
  const auto actor = actor_of(data, colour, opacity);
  actor->GetProperty()->SetAmbientColor(colour[0], colour[1], colour[2]);
  actor->GetProperty()->SetAmbient(0.3);
  return actor;
}

void add_flat(vtkPolyData* data, vtkTexture* texture, const std::array<double, 3>& colour,
              vtkRenderer& renderer) {
  const auto actor = actor_of(data, colour, 1);
  if (texture) actor->SetTexture(texture);
  actor->GetProperty()->LightingOff();
  renderer.AddActor(actor);
}

}  // namespace

void status_colour(int status, double (&rgb)[3]) {
  constexpr std::array<std::array<double, 3>, 4> colours{
      {{0.0, 0.62, 0.451}, {0.835, 0.369, 0.0}, {0.8, 0.475, 0.655}, {0.45, 0.45, 0.45}}};
  const auto& colour = colours[static_cast<std::size_t>(std::clamp(status, 0, 3))];
  std::copy(colour.begin(), colour.end(), rgb);
}

vtkSmartPointer<vtkImageData> picture_of(vtkImageData& light_field) {
  vtkDataArray* const flux = light_field.GetPointData()->GetScalars();
  const auto picture = vtkSmartPointer<vtkImageData>::New();
  picture->CopyStructure(&light_field);
  picture->SetFieldData(light_field.GetFieldData());
  picture->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
  auto* out = static_cast<unsigned char*>(picture->GetScalarPointer());
  std::vector<double> lit;
  for (vtkIdType i = 0; i < flux->GetNumberOfTuples(); ++i)
    if (flux->GetTuple1(i) > 0) lit.push_back(flux->GetTuple1(i));
  double white = 1;
  if (!lit.empty()) {
    const auto place = static_cast<std::ptrdiff_t>(0.999 * static_cast<double>(lit.size() - 1));
    std::nth_element(lit.begin(), lit.begin() + place, lit.end());
    white = lit[static_cast<std::size_t>(place)];
  }
  for (vtkIdType i = 0; i < flux->GetNumberOfTuples(); ++i) {
    const double value = std::pow(std::clamp(flux->GetTuple1(i) / white, 0.0, 1.0), 1 / 2.2);
    for (int k = 0; k < 3; ++k) *out++ = static_cast<unsigned char>(std::lround(255 * value));
  }
  return picture;
}

void add_picture(vtkPolyData* sensor, vtkImageData& picture, vtkRenderer& renderer) {
  if (!sensor || sensor->GetNumberOfCells() == 0) return;
  // A hair in front of the bare sensor, so that the two don't fight for the same depth.
  const auto actor = actor_of(window_of(sensor, picture), {1, 1, 1}, 1);
  actor->SetTexture(texture_of(&picture, false));
  actor->GetProperty()->LightingOff();
  actor->GetMapper()->SetRelativeCoincidentTopologyPolygonOffsetParameters(-2, -2);
  actor->GetMapper()->SetResolveCoincidentTopologyToPolygonOffset();
  renderer.AddActor(actor);
}

void add_camera(vtkMultiBlockDataSet& camera, vtkImageData* plate_texture, double glass,
                vtkRenderer& renderer) {
  const auto block = [&](unsigned which) -> vtkPolyData* {
    auto* const data = vtkPolyData::SafeDownCast(camera.GetBlock(which));
    return data && data->GetNumberOfCells() > 0 ? data : nullptr;
  };
  if (auto* sensor = block(Source::SENSOR)) add_flat(sensor, nullptr, {0.62, 0.64, 0.68}, renderer);
  if (auto* plate = block(Source::ARRAY_PLATE); plate && !block(Source::MICROLENSES)) {
    const auto actor = actor_of(plate, {1, 1, 1}, 0.75);
    actor->SetTexture(texture_of(plate_texture, true));
    actor->GetProperty()->LightingOff();
    renderer.AddActor(actor);
  }
  if (auto* lenses = block(Source::MICROLENSES)) {
    vtkDataArray* const types = lenses->GetCellData()->GetArray("type");
    const auto data = coloured(lenses, [&](vtkIdType i, double* rgb) {
      Source::GetTypeColor(static_cast<int>(types->GetTuple1(i)), rgb);
    });
    const auto actor = actor_of(data, {1, 1, 1}, glass);
    actor->GetMapper()->ScalarVisibilityOn();
    renderer.AddActor(actor);
  }
  if (auto* stop = block(Source::STOP)) renderer.AddActor(body_of(stop, {0.55, 0.55, 0.56}, 0.85));
  if (auto* edges = block(Source::LENS_EDGES))
    renderer.AddActor(body_of(edges, {0.55, 0.7, 0.78}, 0.5 * glass));
  if (auto* surfaces = block(Source::LENS_SURFACES))
    renderer.AddActor(body_of(surfaces, {0.55, 0.78, 0.92}, glass));
}

void add_rays(vtkPolyData& rays, bool by_status, vtkRenderer& renderer) {
  vtkDataArray* const values = rays.GetCellData()->GetArray(by_status ? "status" : "type");
  const auto data = coloured(&rays, [&](vtkIdType i, double* rgb) {
    const int value = values ? static_cast<int>(values->GetTuple1(i)) : -1;
    double own[3];
    if (by_status)
      status_colour(value, own);
    else
      Source::GetTypeColor(value, own);
    std::copy_n(own, 3, rgb);
  });
  const auto actor = actor_of(data, {1, 1, 1}, 1);
  actor->GetMapper()->ScalarVisibilityOn();
  actor->GetProperty()->LightingOff();
  actor->GetProperty()->SetLineWidth(1);
  renderer.AddActor(actor);
}

}  // namespace plenoflame::views
