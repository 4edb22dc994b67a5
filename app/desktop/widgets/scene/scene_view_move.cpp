#include <vtkActor.h>
#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkSphereHandleRepresentation.h>

#include <QAction>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "picture_camera.h"
#include "plenoflame/base/units.h"
#include "widgets/scene/scene_geometry.h"
#include "widgets/scene/scene_view_parts.h"

// The 3-D view's schematic, which is not to scale, and the handles that drag flames and cameras.
namespace plenoflame::desktop {
namespace {

constexpr int kHandlePixels = 9;      ///< radius of a handle on the screen
constexpr double kHandleReach = 12;   ///< [logical pixel] from a handle's middle to the pointer
constexpr int kLabelSize = 13;        ///< [layout pixel]
constexpr double kMountShare = 0.65;  ///< radius of a drawn lens with its mount, of its width

/// Two short slanted lines where the axis is broken; their ends.
std::vector<Vec3> add_break(const Vec3& middle, const Vec3& axis, const Vec3& up, double size,
                            vtkRenderer& renderer) {
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> cells;
  std::vector<Vec3> ends;
  for (const double side : {-1.0, 1.0}) {
    cells->InsertNextCell(2);
    for (const double end : {-1.0, 1.0}) {
      const Vec3 p = middle + size * ((0.3 * side + 0.25 * end) * axis + end * up);
      cells->InsertCellPoint(points->InsertNextPoint(p.x, p.y, p.z));
      ends.push_back(p);
    }
  }
  vtkNew<vtkPolyData> lines;
  lines->SetPoints(points);
  lines->SetLines(cells);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(lines);
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(0.75, 0.77, 0.8);
  actor->GetProperty()->LightingOff();
  actor->GetProperty()->SetLineWidth(2);
  renderer.AddActor(actor);
  return ends;
}

}  // namespace

void SceneView::update_schematic() {
  schematic_ = {};
  other_schematics_.clear();
  if (!scene_ || !geometry_ || part_ != Part::scene) return;
  if (!shortened_->isChecked() || move_->isChecked() || measure_->isChecked()) return;
  other_schematics_ = shortened_axes(geometry_->cameras, geometry_->things());
  schematic_ = other_schematics_.front();
  other_schematics_.erase(other_schematics_.begin());
}

Schematic SceneView::schematic_of(std::size_t camera) const {
  if (camera == 0) return schematic_;
  return camera <= other_schematics_.size() ? other_schematics_[camera - 1] : Schematic();
}

void SceneView::add_gaps_of(std::size_t camera, vtkRenderer& renderer) {
  const Schematic schematic = schematic_of(camera);
  const CameraSpec& spec = camera == 0 ? scene_->scene.camera : others_[camera - 1];
  const Vec3 axis = normalize(spec.look_direction), right = normalize(cross(axis, spec.up)),
             up = cross(right, axis);
  const double width = geometry_->cameras[camera].width;
  for (const Schematic::Gap& gap : schematic.gaps()) {
    const double drawn = gap.drawn_end - gap.drawn_begin;
    const Vec3 middle = schematic.on_axis(0.5 * (gap.drawn_begin + gap.drawn_end));
    std::vector<Vec3> mark = add_break(middle, axis, up, 0.12 * drawn, renderer);
    view_->labels.avoid(mark, SceneLabels::Keep::off);
    if (camera > 0) continue;  // lengths of all cameras would stand in each other's way
    // Rays pass through the mark; where there is room the length stands beside them.
    if (others_.empty()) mark = {middle - 0.5 * width * up, middle + 0.5 * width * up};
    view_->labels.add(readable_quantity(gap.end - gap.begin, Dimension::length, 3), std::move(mark),
                      kLabelSize, renderer);
  }
  std::vector<Vec3> lens;
  constexpr int kCorners = 8;
  for (int i = 0; i < kCorners; ++i) {
    const double angle = 2 * std::numbers::pi * i / kCorners;
    lens.push_back(schematic.place(
        spec.position + kMountShare * width * (std::cos(angle) * right + std::sin(angle) * up)));
  }
  view_->labels.avoid(lens, SceneLabels::Keep::off_if_possible);
  if (!others_.empty()) view_->labels.add(spec.name, std::move(lens), kLabelSize, renderer);
}

/// The true lengths of what is shortened, and the names of several cameras.
void SceneView::add_gaps() {
  view_->replace("gaps", [&](vtkRenderer& renderer) {
    view_->labels.clear();
    if (!scene_ || !geometry_ || part_ != Part::scene) return;
    const std::size_t count = std::min(others_.size() + 1, geometry_->cameras.size());
    for (std::size_t i = 0; i < count; ++i) add_gaps_of(i, renderer);
    if (!geometry_->flame) return;
    std::vector<Vec3> flame;
    std::array<double, 6> box{};
    geometry_->flame->GetBounds(box.data());
    for (const Vec3& corner : views::corners(box)) flame.push_back(schematic_.place(corner));
    view_->labels.avoid(std::move(flame), SceneLabels::Keep::off_if_possible);
  });
}

std::vector<Vec3> SceneView::handles() const {
  std::vector<Vec3> places;
  for (const View::Handle& handle : view_->handles) {
    std::array<double, 3> p{};
    handle.widget->GetHandleRepresentation()->GetWorldPosition(p.data());
    places.push_back({p[0], p[1], p[2]});
  }
  return places;
}

void SceneView::place_handles() {
  const bool wanted = scene_ && geometry_ && move_->isChecked() && !is_close();
  std::vector<View::Handle> handles;
  if (wanted) {
    const auto& flames = scene_->scene.flames;
    for (std::size_t i = 0; i < flames.size() && part_ != Part::camera; ++i) {
      View::Handle handle;
      handle.flame = static_cast<int>(i);
      // The middle of the only flame is what one would grasp; of several each has its own place.
      if (flames.size() == 1 && scene_->medium) {
        const Box box = scene_->medium->bounds();
        handle.offset = 0.5 * (box.lower + box.upper) - flames[i].position;
      }
      handles.push_back(handle);
    }
    if (part_ != Part::flame) handles.push_back({});
  }
  while (view_->handles.size() > handles.size()) {
    view_->handles.back().widget->SetInteractor(nullptr);
    view_->handles.pop_back();
  }
  for (std::size_t i = 0; i < handles.size(); ++i) {
    if (i == view_->handles.size()) {
      handles[i].widget = vtkSmartPointer<vtkHandleWidget>::New();
      vtkNew<vtkSphereHandleRepresentation> ball;
      ball->SetHandleSize(kHandlePixels);
      ball->GetProperty()->SetColor(0.35, 0.75, 1);
      ball->GetSelectedProperty()->SetColor(1, 0.8, 0.3);
      handles[i].widget->SetInteractor(view_->widget->interactor());
      handles[i].widget->SetRepresentation(ball);
      handles[i].widget->ProcessEventsOff();  // drag_handle() tells several of them apart
      handles[i].widget->EnabledOn();
      view_->handles.push_back(handles[i]);
    }
    View::Handle& shown = view_->handles[i];
    shown.flame = handles[i].flame;
    shown.offset = handles[i].offset;
    const Vec3 at =
        shown.offset + (shown.flame < 0
                            ? scene_->scene.camera.position
                            : scene_->scene.flames[static_cast<std::size_t>(shown.flame)].position);
    std::array<double, 3> p{at.x, at.y, at.z};
    auto* const representation = shown.widget->GetHandleRepresentation();
    representation->SetWorldPosition(p.data());
  }
}

bool SceneView::drag_handle(QEvent::Type event, const QPointF& at) {
  const std::vector<Vec3> places = handles();
  if (event == QEvent::MouseButtonPress) {
    double nearest = kHandleReach;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const QPointF way = to_widget(places[i]) - at;
      const double distance = std::hypot(way.x(), way.y());
      if (distance > nearest) continue;
      nearest = distance;
      dragged_ = static_cast<int>(i);
    }
    if (dragged_ >= 0) ++stroke_;
    return dragged_ >= 0;
  }
  if (dragged_ < 0) return false;
  const auto number = static_cast<std::size_t>(dragged_);
  if (event == QEvent::MouseButtonRelease || number >= places.size()) {
    dragged_ = -1;
    return true;
  }
  // In the plane across the line of sight in which the handle is.
  const Vec3 from = places[number];
  vtkRenderer& renderer = *view_->renderer;
  renderer.SetWorldPoint(from.x, from.y, from.z, 1);
  renderer.WorldToDisplay();
  const double depth = renderer.GetDisplayPoint()[2];
  const Vec3 to = drawn_at(at, depth);
  std::array<double, 3> p{to.x, to.y, to.z};
  const View::Handle& handle = view_->handles[number];
  handle.widget->GetHandleRepresentation()->SetWorldPosition(p.data());
  emit moved(handle.flame, to - handle.offset, stroke_);
  render();
  return true;
}

}  // namespace plenoflame::desktop
