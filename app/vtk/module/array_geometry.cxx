#include "array_geometry.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace plenoflame::pipeline {
Vec3 type_colour(int type) {
  // Okabe and Ito's palette: distinct with any colour vision.
  constexpr std::array<Vec3, 3> colours{
      {{0.0, 0.447, 0.698}, {0.902, 0.624, 0.0}, {0.0, 0.62, 0.451}}};
  return type < 0 ? Vec3{0.5, 0.5, 0.5} : colours[static_cast<std::size_t>(type) % colours.size()];
}

vtkSmartPointer<vtkPolyData> polydata_of(const CameraMesh& mesh) {
  auto out = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (const Vec3 p : mesh.points) points->InsertNextPoint(p.x, p.y, p.z);
  vtkNew<vtkCellArray> cells;
  for (std::size_t k = 0; k < mesh.polygons(); ++k) {
    cells->InsertNextCell(static_cast<int>(mesh.offsets[k + 1] - mesh.offsets[k]));
    for (std::int64_t at = mesh.offsets[k]; at < mesh.offsets[k + 1]; ++at)
      cells->InsertCellPoint(mesh.connectivity[static_cast<std::size_t>(at)]);
  }
  out->SetPoints(points);
  out->SetPolys(cells);
  if (!mesh.normals.empty()) {
    vtkNew<vtkFloatArray> normals;
    normals->SetName("Normals");
    normals->SetNumberOfComponents(3);
    for (const Vec3 n : mesh.normals) normals->InsertNextTuple3(n.x, n.y, n.z);
    out->GetPointData()->SetNormals(normals);
  }
  if (!mesh.texture.empty()) {
    vtkNew<vtkFloatArray> coordinates;
    coordinates->SetName("TextureCoordinates");
    coordinates->SetNumberOfComponents(2);
    for (const Vec2 t : mesh.texture) coordinates->InsertNextTuple2(t.x, t.y);
    out->GetPointData()->SetTCoords(coordinates);
  }
  if (mesh.surfaces.empty()) return out;
  vtkNew<vtkIntArray> surfaces, types, lenses;
  surfaces->SetName("surface");
  types->SetName("type");
  lenses->SetName("microlens");
  lenses->SetNumberOfComponents(2);
  for (const int surface : mesh.surfaces) surfaces->InsertNextValue(surface);
  for (const int type : mesh.types) types->InsertNextValue(type);
  for (const LensIndex lens : mesh.lenses) lenses->InsertNextTuple2(lens.q, lens.r);
  for (vtkIntArray* array : {surfaces.Get(), types.Get(), lenses.Get()})
    out->GetCellData()->AddArray(array);
  return out;
}

vtkSmartPointer<vtkImageData> array_texture(const Camera& camera) {
  ArraySpec array = camera.spec().array;
  array.rotation = 0;
  array.offset = {};
  array.columns = array.rows = 0;
  const MicrolensAperture aperture(array);
  const MicrolensLattice lattice(array);
  const Vec2 side = array_period(array);
  constexpr int kPerPitch = 48;
  const int width = static_cast<int>(std::lround(side.x / array.pitch * kPerPitch));
  const int height = static_cast<int>(std::lround(side.y / array.pitch * kPerPitch));
  const auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(width, height, 1);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
  auto* out = static_cast<unsigned char*>(image->GetScalarPointer());
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Vec2 at{side.x * (x + 0.5) / width, side.y * (y + 0.5) / height};
      const LensIndex lens = lattice.nearest(at);
      const Vec2 off = at - lattice.centre(lens);
      const double r = length(off) / reach_of(aperture, std::atan2(off.y, off.x));
      // Brighter in the middle, so that they look like lenses; dark between them.
      const Vec3 colour = type_colour(lattice.type(lens));
      const double light = r < 1 ? 1 - 0.55 * r * r : 0.12;
      for (const double c : {colour.x, colour.y, colour.z})
        *out++ = static_cast<unsigned char>(
            std::lround(255 * std::clamp(r < 1 ? light * (0.35 + 0.65 * c) : light, 0.0, 1.0)));
    }
  return image;
}

}  // namespace plenoflame::pipeline
