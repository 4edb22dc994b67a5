#include "surface_props.h"

#include <vtkActor.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkFeatureEdges.h>
#include <vtkFloatArray.h>
#include <vtkLight.h>
#include <vtkLightCollection.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>
#include <vtkUnsignedCharArray.h>

#include <array>
#include <cmath>
#include <filesystem>

#include "plenoflame/scene/scene.h"
#include "plenoflame/solids/surface_mesh.h"

namespace plenoflame::views {
namespace {

std::array<unsigned char, 3> colour_of(const MaterialSpec& material, float reflectivity) {
  switch (material.kind) {
    case MaterialKind::black:
      return {55, 55, 58};
    case MaterialKind::blackbody:
      return {240, 150, 50};
    case MaterialKind::emitter:
      return {255, 225, 140};
    default:
      break;
  }
  // A body that reflects nothing is a little brighter than the background, to be seen before it.
  const double value = 55 + 185 * std::pow(static_cast<double>(reflectivity), 1 / 2.2);
  const auto grey = static_cast<unsigned char>(std::lround(value));
  return {grey, grey, grey};
}

vtkSmartPointer<vtkPolyData> polydata_of(const SurfaceMesh& mesh, const MaterialSpec& material) {
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(static_cast<vtkIdType>(mesh.vertices.size()));
  vtkNew<vtkFloatArray> normals;
  normals->SetNumberOfComponents(3);
  normals->SetNumberOfTuples(points->GetNumberOfPoints());
  for (std::size_t k = 0; k < mesh.vertices.size(); ++k) {
    const auto at = static_cast<vtkIdType>(k);
    points->SetPoint(at, mesh.vertices[k].x, mesh.vertices[k].y, mesh.vertices[k].z);
    normals->SetTuple3(at, mesh.normals[k].x, mesh.normals[k].y, mesh.normals[k].z);
  }
  vtkNew<vtkCellArray> cells;
  vtkNew<vtkUnsignedCharArray> colours;
  colours->SetName("colour");
  colours->SetNumberOfComponents(3);
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
    const auto& t = mesh.triangles[k];
    cells->InsertNextCell(
        {static_cast<vtkIdType>(t[0]), static_cast<vtkIdType>(t[1]), static_cast<vtkIdType>(t[2])});
    colours->InsertNextTypedTuple(colour_of(material, mesh.reflectivity[k]).data());
  }
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(points);
  data->SetPolys(cells);
  data->GetPointData()->SetNormals(normals);
  data->GetCellData()->SetScalars(colours);
  return data;
}

}  // namespace

SolidSurfaces solid_surfaces(const Scene& scene, vtkBoundingBox others) {
  SolidSurfaces out;
  const std::string folder = std::filesystem::path(scene.file).parent_path().string();
  const auto add = [&](const SolidSurfaceSpec& spec, const SurfaceMeshSettings& settings) {
    SolidSurfaces::Part part;
    part.data = polydata_of(surface_mesh(spec, folder, settings), spec.material);
    part.flat = spec.shape == SolidShape::plane || spec.shape == SolidShape::disc;
    part.glows = spec.material.kind == MaterialKind::blackbody ||
                 spec.material.kind == MaterialKind::emitter;
    out.parts.push_back(part);
  };
  const auto endless = [](const SolidSurfaceSpec& spec) {
    return spec.shape == SolidShape::plane &&
           (std::isinf(spec.extent.x) || std::isinf(spec.extent.y));
  };
  for (const SolidSurfaceSpec& spec : scene.surfaces) {
    if (endless(spec)) continue;
    add(spec, {});
    out.all.AddBounds(out.parts.back().data->GetBounds());
    if (spec.shape != SolidShape::plane) out.bodies.AddBounds(out.parts.back().data->GetBounds());
  }
  // Planes without end come last: each is as large as all that has one.
  if (out.all.IsValid()) others.AddBox(out.all);
  SurfaceMeshSettings settings;
  if (others.IsValid()) {
    double middle[3];
    others.GetCenter(middle);
    settings.endless_near = {middle[0], middle[1], middle[2]};
    settings.endless = 1.2 * others.GetDiagonalLength();
  }
  for (const SolidSurfaceSpec& spec : scene.surfaces)
    if (endless(spec)) add(spec, settings);
  return out;
}

void add_surfaces(const SolidSurfaces& surfaces, vtkRenderer& renderer) {
  if (surfaces.parts.empty()) return;
  for (const SolidSurfaces::Part& part : surfaces.parts) {
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputData(part.data);
    vtkNew<vtkActor> actor;
    actor->SetMapper(mapper);
    actor->GetProperty()->SetAmbient(part.glows ? 1 : 0.25);
    actor->GetProperty()->SetDiffuse(part.glows ? 0 : 0.8);
    actor->GetProperty()->SetSpecular(0);
    renderer.AddActor(actor);
    if (!part.flat) continue;
    vtkNew<vtkFeatureEdges> edges;
    edges->SetInputData(part.data);
    edges->BoundaryEdgesOn();
    edges->FeatureEdgesOff();
    edges->NonManifoldEdgesOff();
    edges->ManifoldEdgesOff();
    edges->ColoringOff();
    vtkNew<vtkPolyDataMapper> lines;
    lines->SetInputConnection(edges->GetOutputPort());
    lines->ScalarVisibilityOff();
    vtkNew<vtkActor> rim;
    rim->SetMapper(lines);
    rim->GetProperty()->SetColor(0.35, 0.35, 0.38);
    rim->GetProperty()->LightingOff();
    renderer.AddActor(rim);
  }
  if (renderer.GetLights()->GetNumberOfItems() > 0) return;
  // In the eye's own frame: from the eye, and from its upper left.
  const auto light = [&](double x, double y, double z, double intensity) {
    vtkNew<vtkLight> added;
    added->SetLightTypeToCameraLight();
    added->SetPosition(x, y, z);
    added->SetFocalPoint(0, 0, 0);
    added->SetIntensity(intensity);
    renderer.AddLight(added);
  };
  light(0, 0, 1, 0.45);
  light(-0.8, 1, 0.7, 0.65);
}

}  // namespace plenoflame::views
