#include "lens_geometry.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkFloatArray.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>

namespace plenoflame::pipeline {
namespace {

constexpr double kDiaphragmWidth = 1.25;  ///< outer over inner diameter

double widest(const Camera& camera) {
  double diameter = camera.spec().lens.diameter;
  for (const SurfaceSpec& s : camera.spec().lens.surfaces)
    diameter = std::max(diameter, s.diameter);
  return diameter;
}

}  // namespace

double surface_height(double vertex, double radius, double r) {
  if (!std::isfinite(radius)) return vertex;
  const double t = std::min(1.0, r * r / (radius * radius));
  return vertex - r * r / (radius * (1 + std::sqrt(1 - t)));
}

struct SurfaceBuilder::Internals {
  RigidTransform to_world;
  vtkNew<vtkPoints> points;
  vtkNew<vtkFloatArray> normals;
  vtkNew<vtkCellArray> cells;
  vtkNew<vtkIntArray> surfaces, types, lenses;
  int surface = -1, type = -1;
  LensIndex lens;

  vtkIdType point(Vec3 at, Vec3 normal) {
    const Vec3 p = to_world.point(at), n = to_world.direction(normal);
    normals->InsertNextTuple3(n.x, n.y, n.z);
    return points->InsertNextPoint(p.x, p.y, p.z);
  }
  void polygon(std::initializer_list<vtkIdType> ids) {
    cells->InsertNextCell(static_cast<vtkIdType>(ids.size()), std::data(ids));
    surfaces->InsertNextValue(surface);
    types->InsertNextValue(type);
    lenses->InsertNextTuple2(lens.q, lens.r);
  }
};

SurfaceBuilder::SurfaceBuilder(const RigidTransform& to_world, const Tessellation& tessellation)
    : in_(std::make_unique<Internals>()), tessellation_(tessellation) {
  in_->to_world = to_world;
  in_->points->SetDataTypeToDouble();
  in_->normals->SetName("Normals");
  in_->normals->SetNumberOfComponents(3);
  in_->surfaces->SetName("surface");
  in_->types->SetName("type");
  in_->lenses->SetName("microlens");
  in_->lenses->SetNumberOfComponents(2);
}

SurfaceBuilder::~SurfaceBuilder() = default;

void SurfaceBuilder::tag(int surface, int type, LensIndex lens) {
  in_->surface = surface;
  in_->type = type;
  in_->lens = lens;
}

void SurfaceBuilder::cap(Vec2 centre, double vertex, double radius, double diameter) {
  const int sectors = tessellation_.sectors, rings = tessellation_.rings;
  const auto normal = [&](double r, double phi) -> Vec3 {
    if (!std::isfinite(radius)) return {0, 0, 1};
    const double s = r / radius;
    return {s * std::cos(phi), s * std::sin(phi), std::sqrt(std::max(0.0, 1 - s * s))};
  };
  const vtkIdType middle = in_->point({centre.x, centre.y, vertex}, {0, 0, 1});
  for (int ring = 1; ring <= rings; ++ring) {
    const double r = 0.5 * diameter * ring / rings;
    for (int k = 0; k < sectors; ++k) {
      const double phi = 2 * std::numbers::pi * k / sectors;
      in_->point({centre.x + r * std::cos(phi), centre.y + r * std::sin(phi),
                  surface_height(vertex, radius, r)},
                 normal(r, phi));
    }
    const vtkIdType outer = middle + 1 + static_cast<vtkIdType>(ring - 1) * sectors;
    for (vtkIdType k = 0; k < sectors; ++k) {
      const vtkIdType next = (k + 1) % sectors;
      if (ring == 1)
        in_->polygon({middle, outer + k, outer + next});
      else
        in_->polygon({outer - sectors + k, outer + k, outer + next, outer - sectors + next});
    }
  }
}

void SurfaceBuilder::ring(double z, double inner_diameter, double outer_diameter) {
  const vtkIdType sectors = tessellation_.sectors;
  vtkIdType first = -1;
  for (vtkIdType k = 0; k < sectors; ++k) {
    const double phi = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(sectors);
    const double x = 0.5 * std::cos(phi), y = 0.5 * std::sin(phi);
    const vtkIdType id = in_->point({inner_diameter * x, inner_diameter * y, z}, {0, 0, 1});
    in_->point({outer_diameter * x, outer_diameter * y, z}, {0, 0, 1});
    if (k == 0) first = id;
  }
  for (vtkIdType k = 0; k < sectors; ++k) {
    const vtkIdType a = first + 2 * k, b = first + 2 * ((k + 1) % sectors);
    in_->polygon({a, a + 1, b + 1, b});
  }
}

void SurfaceBuilder::band(double z0, double diameter0, double z1, double diameter1) {
  const vtkIdType sectors = tessellation_.sectors;
  vtkIdType first = -1;
  for (vtkIdType k = 0; k < sectors; ++k) {
    const double phi = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(sectors);
    const double c = std::cos(phi), s = std::sin(phi);
    const vtkIdType id = in_->point({0.5 * diameter0 * c, 0.5 * diameter0 * s, z0}, {c, s, 0});
    in_->point({0.5 * diameter1 * c, 0.5 * diameter1 * s, z1}, {c, s, 0});
    if (k == 0) first = id;
  }
  for (vtkIdType k = 0; k < sectors; ++k) {
    const vtkIdType a = first + 2 * k, b = first + 2 * ((k + 1) % sectors);
    in_->polygon({a, a + 1, b + 1, b});
  }
}

vtkSmartPointer<vtkPolyData> SurfaceBuilder::take() {
  const auto out = vtkSmartPointer<vtkPolyData>::New();
  out->SetPoints(in_->points);
  out->SetPolys(in_->cells);
  out->GetPointData()->SetNormals(in_->normals);
  for (vtkIntArray* array : {in_->surfaces.Get(), in_->types.Get(), in_->lenses.Get()})
    out->GetCellData()->AddArray(array);
  return out;
}

vtkSmartPointer<vtkPolyData> lens_surfaces(const Camera& camera, const Tessellation& tessellation) {
  SurfaceBuilder builder(camera.to_world(), tessellation);
  if (camera.ideal_lens()) {
    const IdealLens& lens = camera.ideal();
    const double diameter = widest(camera);
    builder.tag(0, -1, {});
    builder.cap({}, lens.front_principal, kInfinity, diameter);
    if (lens.rear_principal != lens.front_principal)
      builder.cap({}, lens.rear_principal, kInfinity, diameter);
    return builder.take();
  }
  const auto& surfaces = camera.lens().surfaces();
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    // Between air and air there is only the diaphragm to see.
    const double before = s == 0 ? 1 : surfaces[s - 1].index;
    if (before == surfaces[s].index) continue;
    builder.tag(static_cast<int>(s), -1, {});
    builder.cap({}, camera.lens().vertices()[s], surfaces[s].radius, surfaces[s].diameter);
  }
  return builder.take();
}

vtkSmartPointer<vtkPolyData> lens_edges(const Camera& camera, const Tessellation& tessellation) {
  SurfaceBuilder builder(camera.to_world(), tessellation);
  if (camera.ideal_lens()) return builder.take();
  const auto& surfaces = camera.lens().surfaces();
  for (std::size_t s = 0; s + 1 < surfaces.size(); ++s) {
    if (surfaces[s].index == 1) continue;
    const auto edge = [&](std::size_t k) {
      return surface_height(camera.lens().vertices()[k], surfaces[k].radius,
                            0.5 * surfaces[k].diameter);
    };
    builder.tag(static_cast<int>(s), -1, {});
    builder.band(edge(s), surfaces[s].diameter, edge(s + 1), surfaces[s + 1].diameter);
  }
  return builder.take();
}

vtkSmartPointer<vtkPolyData> stop_ring(const Camera& camera, const Tessellation& tessellation) {
  SurfaceBuilder builder(camera.to_world(), tessellation);
  const auto& surfaces = camera.spec().lens.surfaces;
  double z = 0, inner = camera.spec().lens.diameter;
  int number = 0;
  double vertex = 0;
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    if (surfaces[s].stop) {
      inner = surfaces[s].diameter;
      z = surface_height(vertex, surfaces[s].radius, 0.5 * inner);
      number = static_cast<int>(s);
    }
    vertex -= surfaces[s].thickness;
  }
  builder.tag(number, -1, {});
  builder.ring(z, inner, kDiaphragmWidth * std::max(inner, widest(camera)));
  return builder.take();
}

vtkSmartPointer<vtkPolyData> sensor_rectangle(const Camera& camera) {
  const SensorSpec& sensor = camera.spec().sensor;
  const auto out = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkFloatArray> coordinates;
  coordinates->SetName("TextureCoordinates");
  coordinates->SetNumberOfComponents(2);
  vtkNew<vtkCellArray> cells;
  const std::array<std::array<double, 2>, 4> corners{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  for (const auto& [u, v] : corners) {
    const Vec2 at = camera.sensor_point(u * sensor.columns, (1 - v) * sensor.rows);
    const Vec3 p = camera.to_world().point({at.x, at.y, camera.sensor()});
    points->InsertNextPoint(p.x, p.y, p.z);
    coordinates->InsertNextTuple2(u, v);
  }
  const std::array<vtkIdType, 4> ids{0, 1, 2, 3};
  cells->InsertNextCell(4, ids.data());
  out->SetPoints(points);
  out->SetPolys(cells);
  out->GetPointData()->SetTCoords(coordinates);
  return out;
}

}  // namespace plenoflame::pipeline
