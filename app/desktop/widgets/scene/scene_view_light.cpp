#include <vtkActor.h>
#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>

#include <QAction>
#include <algorithm>
#include <cmath>

#include "scene_props.h"
#include "vtkPlenoflameCameraSource.h"
#include "widgets/scene/ray_lines.h"
#include "widgets/scene/scene_geometry.h"
#include "widgets/scene/scene_view_parts.h"

// Light that runs along the rays that are drawn, from the scene to the sensor, and the picture
// there.
namespace plenoflame::desktop {
namespace {

constexpr std::size_t kMostWays = 48;  ///< rays that light is drawn on
constexpr double kPulses = 5;          ///< on a ray at a time
constexpr double kSeconds = 4;         ///< for the whole way
constexpr int kLeastPause = 40;        ///< [ms] between two pictures
constexpr float kPointSize = 5;        ///< [screen pixel]

}  // namespace

/// The ways of light: rays that reach the scene, backwards.
void SceneView::find_ways() {
  view_->ways.clear();
  if (!rays_ || !light_->isChecked()) return;
  const auto& rays = rays_->paths.rays;
  std::vector<std::size_t> lit;
  for (std::size_t i = 0; i < rays.size(); ++i)
    if (rays[i].count > 1 && rays[i].status.status == RayStatus::reached) lit.push_back(i);
  const std::size_t step = std::max<std::size_t>(1, (lit.size() + kMostWays - 1) / kMostWays);
  for (std::size_t i = 0; i < lit.size(); i += step) {
    View::Way way;
    way.points = drawn_ray(rays_->paths, lit[i], schematic_);
    std::reverse(way.points.begin(), way.points.end());
    way.lengths.push_back(0);
    for (std::size_t k = 1; k < way.points.size(); ++k)
      way.lengths.push_back(way.lengths.back() + length(way.points[k] - way.points[k - 1]));
    view_->ways.push_back(std::move(way));
  }
}

void SceneView::run_light(bool on) {
  find_ways();
  if (view_->light_points) view_->renderer->RemoveViewProp(view_->light_points);
  view_->light_points = nullptr;
  light_timer_.stop();
  if (on) {
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputData(view_->light);
    vtkNew<vtkActor> actor;
    actor->SetMapper(mapper);
    actor->GetProperty()->SetColor(1, 0.95, 0.7);
    actor->GetProperty()->LightingOff();
    actor->GetProperty()->SetPointSize(kPointSize);
    actor->PickableOff();
    view_->light_points = actor;
    view_->renderer->AddViewProp(actor);
    view_->light_since.start();
    move_light();
  }
  render();
}

void SceneView::move_light() {
  if (!light_->isChecked()) return;
  QElapsedTimer drawing;
  drawing.start();
  const double phase =
      std::fmod(1e-3 * static_cast<double>(view_->light_since.elapsed()) / kSeconds, 1 / kPulses);
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> cells;
  for (const View::Way& way : view_->ways)
    for (double share = phase; share < 1; share += 1 / kPulses) {
      const double at = share * way.lengths.back();
      const auto after = std::upper_bound(way.lengths.begin(), way.lengths.end(), at);
      const auto k = static_cast<std::size_t>(std::max<std::ptrdiff_t>(
          1, std::min<std::ptrdiff_t>(after - way.lengths.begin(),
                                      static_cast<std::ptrdiff_t>(way.lengths.size()) - 1)));
      const double piece = way.lengths[k] - way.lengths[k - 1];
      const double t = piece > 0 ? (at - way.lengths[k - 1]) / piece : 0;
      const Vec3 p = way.points[k - 1] + t * (way.points[k] - way.points[k - 1]);
      cells->InsertNextCell(1);
      cells->InsertCellPoint(points->InsertNextPoint(p.x, p.y, p.z));
    }
  view_->light->SetPoints(points);
  view_->light->SetVerts(cells);
  view_->light->Modified();
  if (isVisible() && !view_->ways.empty()) view_->window->Render();
  // A slow machine has time for the rest as well.
  light_timer_.start(std::max<int>(kLeastPause, static_cast<int>(2 * drawing.elapsed())));
}

void SceneView::set_picture(vtkSmartPointer<vtkImageData> picture) {
  picture_ = std::move(picture);
  if (!geometry_ || held_) return;
  add_picture();
  render();
}

void SceneView::add_picture() {
  view_->replace("picture", [&](vtkRenderer& renderer) {
    auto* const sensor = vtkPolyData::SafeDownCast(
        geometry_->drawn[0].parts->GetBlock(vtkPlenoflameCameraSource::SENSOR));
    if (picture_ && sensor)
      views::add_picture(placed(sensor, schematic_of(0)), *picture_, renderer);
  });
}

}  // namespace plenoflame::desktop
