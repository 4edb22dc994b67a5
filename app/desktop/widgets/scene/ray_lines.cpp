#include "widgets/scene/ray_lines.h"

#include <vtkActor.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>
#include <vtkUnsignedCharArray.h>

#include <QColor>
#include <algorithm>

#include "widgets/image/image_view.h"
#include "widgets/scene/section_view.h"

namespace plenoflame::desktop {
namespace {

constexpr float kHighlightWidth = 4;  ///< [screen pixel] of the chosen ray
constexpr int kLighter = 150;         ///< [%] on a dark ground

}  // namespace

QColor ray_colour(const RayPath& ray, bool dark) {
  const bool typed = ray.status.status == RayStatus::reached && ray.type >= 0;
  return typed ? type_colour(ray.type).lighter(dark ? kLighter : 100)
               : status_colour(ray.status.status, dark);
}

std::vector<Vec3> drawn_ray(const RayPaths& paths, std::size_t ray, const Schematic& schematic) {
  std::vector<Vec3> points;
  const std::size_t first = paths.rays[ray].first;
  for (std::size_t k = first; k < first + paths.rays[ray].count; ++k) {
    const Vec3 p = paths.vertices[k].position;
    if (points.empty()) {
      points.push_back(schematic.place(p));
      continue;
    }
    const auto line = schematic.line(paths.vertices[k - 1].position, p);
    points.insert(points.end(), line.begin(), line.end());
  }
  return points;
}

void add_ray_lines(const RayPaths& paths, int chosen_ray, bool dark, const Schematic& schematic,
                   vtkRenderer& renderer) {
  const auto& rays = paths.rays;
  const auto add = [&](std::size_t begin, std::size_t end, float width, auto ink_of) {
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> cells;
    vtkNew<vtkUnsignedCharArray> colours;
    colours->SetNumberOfComponents(3);
    for (std::size_t i = begin; i < end; ++i) {
      if (rays[i].count < 2) continue;
      const std::vector<Vec3> drawn = drawn_ray(paths, i, schematic);
      cells->InsertNextCell(static_cast<int>(drawn.size()));
      for (const Vec3& p : drawn) cells->InsertCellPoint(points->InsertNextPoint(p.x, p.y, p.z));
      const QColor ink = ink_of(rays[i]);
      colours->InsertNextTuple3(ink.red(), ink.green(), ink.blue());
    }
    vtkNew<vtkPolyData> lines;
    lines->SetPoints(points);
    lines->SetLines(cells);
    lines->GetCellData()->SetScalars(colours);
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputData(lines);
    vtkNew<vtkActor> actor;
    actor->SetMapper(mapper);
    actor->GetProperty()->LightingOff();
    actor->GetProperty()->SetLineWidth(width);
    renderer.AddActor(actor);
  };
  add(0, rays.size(), 1, [&](const RayPath& ray) { return ray_colour(ray, dark); });
  const auto chosen = static_cast<std::size_t>(std::max(0, chosen_ray));
  if (chosen_ray >= 0 && chosen < rays.size())
    add(chosen, chosen + 1, kHighlightWidth, [](const RayPath&) { return chosen_colour(); });
}

}  // namespace plenoflame::desktop
