#include "ray_path_data.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkStringArray.h>
#include <vtkTypeInt64Array.h>

namespace plenoflame::pipeline {
namespace {

/// value(i, k) gives component k of entry i.
template <class Array, class Value>
void add(vtkDataSetAttributes& data, const char* name, std::size_t count, std::size_t components,
         Value value, const std::vector<std::string>& component_names = {}) {
  vtkNew<Array> array;
  array->SetName(name);
  array->SetNumberOfComponents(static_cast<int>(components));
  for (std::size_t k = 0; k < component_names.size(); ++k)
    array->SetComponentName(static_cast<vtkIdType>(k), component_names[k].c_str());
  array->SetNumberOfTuples(static_cast<vtkIdType>(count));
  auto* out = array->GetPointer(0);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < components; ++k) *out++ = value(i, k);
  data.AddArray(array);
}

}  // namespace

void ray_paths_to_polydata(const RayPaths& paths, vtkPolyData& out) {
  const auto& rays = paths.rays;
  const auto& vertices = paths.vertices;
  const std::size_t n = rays.size(), channels = paths.channels.size(), m = vertices.size();
  out.Initialize();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(static_cast<vtkIdType>(m));
  for (std::size_t i = 0; i < m; ++i)
    points->SetPoint(static_cast<vtkIdType>(i), vertices[i].position.x, vertices[i].position.y,
                     vertices[i].position.z);
  // The vertices of a ray follow one another, ray by ray.
  vtkNew<vtkTypeInt64Array> connectivity, offsets;
  connectivity->SetNumberOfValues(static_cast<vtkIdType>(m));
  for (std::size_t i = 0; i < m; ++i)
    connectivity->SetValue(static_cast<vtkIdType>(i), static_cast<vtkTypeInt64>(i));
  offsets->SetNumberOfValues(static_cast<vtkIdType>(n + 1));
  offsets->SetValue(0, 0);
  for (std::size_t i = 0; i < n; ++i)
    offsets->SetValue(static_cast<vtkIdType>(i + 1),
                      static_cast<vtkTypeInt64>(rays[i].first + rays[i].count));
  vtkNew<vtkCellArray> lines;
  lines->SetData(offsets, connectivity);
  out.SetPoints(points);
  out.SetLines(lines);

  vtkDataSetAttributes& cell = *out.GetCellData();
  const auto whole = [&](const char* name, auto value) {
    add<vtkIntArray>(cell, name, n, 1, [&](std::size_t i, std::size_t) { return value(rays[i]); });
  };
  const auto real = [&](const char* name, auto value) {
    add<vtkDoubleArray>(cell, name, n, 1,
                        [&](std::size_t i, std::size_t) { return value(rays[i]); });
  };
  add<vtkIntArray>(
      cell, "pixel", n, 2,
      [&](std::size_t i, std::size_t k) { return k == 0 ? rays[i].column : rays[i].row; },
      {"column", "row"});
  add<vtkIntArray>(
      cell, "microlens", n, 2,
      [&](std::size_t i, std::size_t k) { return k == 0 ? rays[i].lens.q : rays[i].lens.r; },
      {"q", "r"});
  whole("type", [](const RayPath& ray) { return ray.type; });
  whole("status", [](const RayPath& ray) { return static_cast<int>(ray.status.status); });
  whole("ended_at", [](const RayPath& ray) { return ray.status.surface; });
  whole("solid", [](const RayPath& ray) { return ray.solid; });
  add<vtkDoubleArray>(
      cell, "wavelength", n, channels,
      [&](std::size_t, std::size_t k) { return paths.wavelengths[k]; }, paths.channels);
  real("weight", [](const RayPath& ray) { return ray.weight; });
  add<vtkDoubleArray>(
      cell, "radiance", n, channels,
      [&](std::size_t i, std::size_t k) { return paths.radiance_of(i, k); }, paths.channels);
  real("optical_thickness", [](const RayPath& ray) { return ray.optical_thickness; });

  vtkDataSetAttributes& point = *out.GetPointData();
  add<vtkIntArray>(point, "surface", m, 1,
                   [&](std::size_t i, std::size_t) { return vertices[i].surface; });
  const auto along = [&](const char* name, double RayVertex::*value) {
    add<vtkDoubleArray>(point, name, m, 1,
                        [&](std::size_t i, std::size_t) { return vertices[i].*value; });
  };
  along("refractive_index", &RayVertex::index);
  along("distance", &RayVertex::distance);
  along("temperature", &RayVertex::temperature);
  along("absorption", &RayVertex::absorption);

  vtkNew<vtkStringArray> surfaces;
  surfaces->SetName("surfaces");
  for (const std::string& name : paths.surfaces) surfaces->InsertNextValue(name);
  out.GetFieldData()->AddArray(surfaces);
}

}  // namespace plenoflame::pipeline
