#include "array_geometry.h"

#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace plenoflame::pipeline {
namespace {

/// Sides of the repeating rectangle [m], along the lattice's axes.
Vec2 period(const ArraySpec& array) {
  const int types = static_cast<int>(array.types.size());
  if (array.lattice == Lattice::square) return {array.pitch * types, array.pitch * types};
  // Two rows up and one lens back is straight up; it changes the type by 3, none of 1 or 3 types.
  return {array.pitch * types, array.pitch * std::sqrt(3.0) * (types == 2 ? 2 : 1)};
}

/// From the array's plane to the lattice's own axes.
Vec2 unturned(const ArraySpec& array, Vec2 p) {
  const Vec2 d = p - array.offset;
  const double c = std::cos(array.rotation), s = std::sin(array.rotation);
  return {c * d.x + s * d.y, -s * d.x + c * d.y};
}

}  // namespace

Vec3 type_colour(int type) {
  // Okabe and Ito's palette: told apart with any colour vision.
  constexpr std::array<Vec3, 3> colours{
      {{0.0, 0.447, 0.698}, {0.902, 0.624, 0.0}, {0.0, 0.62, 0.451}}};
  return type < 0 ? Vec3{0.5, 0.5, 0.5} : colours[static_cast<std::size_t>(type) % colours.size()];
}

std::vector<LensIndex> microlenses_over(const Camera& camera, PixelWindow window) {
  const SensorSpec& sensor = camera.spec().sensor;
  if (window.width == 0) window = {0, 0, sensor.columns, sensor.rows};
  // Columns and rows run against the camera's axes.
  const Vec2 upper = camera.sensor_point(window.x, window.y);
  const Vec2 lower = camera.sensor_point(window.x + window.width, window.y + window.height);
  const double pitch = camera.spec().array.pitch;
  return camera.lattice().within(lower - Vec2{pitch, pitch}, upper + Vec2{pitch, pitch});
}

vtkSmartPointer<vtkPolyData> microlens_surfaces(const Camera& camera,
                                                const std::vector<LensIndex>& lenses,
                                                const Tessellation& tessellation) {
  SurfaceBuilder builder(camera.to_world(), tessellation);
  const double diameter = camera.spec().array.diameter;
  const int front = camera.surface_count() - (camera.ideal_array() ? 1 : 2);
  for (const LensIndex lens : lenses) {
    const Vec2 centre = camera.lattice().centre(lens);
    const int type = camera.lattice().type(lens);
    const Microlens& kind = camera.microlenses()[static_cast<std::size_t>(type)];
    builder.tag(front, type, lens);
    if (camera.ideal_array()) {
      builder.cap(centre, kind.rear_principal, kInfinity, diameter);
      continue;
    }
    builder.cap(centre, camera.array_front(), kind.radius_front, diameter);
    builder.tag(front + 1, type, lens);
    // Convex towards the sensor: the centre is on the scene's side.
    builder.cap(centre, camera.array_back(), -kind.radius_back, diameter);
  }
  return builder.take();
}

vtkSmartPointer<vtkPolyData> array_plate(const Camera& camera) {
  const SensorSpec& sensor = camera.spec().sensor;
  const ArraySpec& array = camera.spec().array;
  const auto out = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkFloatArray> coordinates;
  coordinates->SetName("TextureCoordinates");
  coordinates->SetNumberOfComponents(2);
  const Vec2 repeat = period(array);
  for (const auto& [u, v] :
       std::array<std::array<double, 2>, 4>{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}}) {
    const Vec2 at = camera.sensor_point(u * sensor.columns, v * sensor.rows);
    const Vec3 p = camera.to_world().point({at.x, at.y, camera.array_front()});
    points->InsertNextPoint(p.x, p.y, p.z);
    const Vec2 own = unturned(array, at);
    coordinates->InsertNextTuple2(own.x / repeat.x, own.y / repeat.y);
  }
  vtkNew<vtkCellArray> cells;
  const std::array<vtkIdType, 4> ids{0, 1, 2, 3};
  cells->InsertNextCell(4, ids.data());
  out->SetPoints(points);
  out->SetPolys(cells);
  out->GetPointData()->SetTCoords(coordinates);
  return out;
}

vtkSmartPointer<vtkImageData> array_texture(const Camera& camera) {
  ArraySpec array = camera.spec().array;
  array.rotation = 0;
  array.offset = {};
  const MicrolensLattice lattice(array);
  const Vec2 side = period(array);
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
      const double r = length(at - lattice.centre(lens)) / (0.5 * array.diameter);
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
