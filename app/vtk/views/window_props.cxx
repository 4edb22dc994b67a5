#include "window_props.h"

#include <vtkActor.h>
#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>

#include "plenoflame/optics/window_set.h"
#include "plenoflame/scene/scene.h"

namespace plenoflame::views {

std::vector<std::vector<Vec3>> window_outlines(const Scene& scene) {
  const WindowSet windows(scene.windows);
  std::vector<std::vector<Vec3>> outlines;
  for (int w = 0; w < windows.size(); ++w)
    for (std::vector<Vec3>& loop : windows.outline(w)) outlines.push_back(std::move(loop));
  return outlines;
}

void add_windows(const std::vector<std::vector<Vec3>>& outlines, vtkRenderer& renderer) {
  if (outlines.empty()) return;
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkCellArray> lines;
  for (const std::vector<Vec3>& loop : outlines) {
    lines->InsertNextCell(static_cast<int>(loop.size()));
    for (const Vec3 p : loop) lines->InsertCellPoint(points->InsertNextPoint(p.x, p.y, p.z));
  }
  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  data->SetLines(lines);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(data);
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(0.2, 0.5, 0.65);
  actor->GetProperty()->SetLineWidth(1.4F);
  actor->GetProperty()->SetLighting(false);
  renderer.AddActor(actor);
}

}  // namespace plenoflame::views
