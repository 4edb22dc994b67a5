#include <vtkCamera.h>

#include <QAction>
#include <QMouseEvent>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "model/scene_target.h"
#include "picture_camera.h"
#include "widgets/pointer.h"
#include "widgets/scene_geometry.h"
#include "widgets/scene_view_parts.h"

// Direction in which the 3-D view looks, and what is pointed at in it.
namespace plenoflame::desktop {

QPointF SceneView::to_widget(const Vec3& world) const {
  const double ratio = view_->widget->devicePixelRatioF();
  const int* const size = view_->renderer->GetSize();
  const Vec3 drawn = schematic_.place(world);
  view_->renderer->SetWorldPoint(drawn.x, drawn.y, drawn.z, 1);
  view_->renderer->WorldToDisplay();
  const double* const p = view_->renderer->GetDisplayPoint();
  return {p[0] / ratio, (size[1] - 1 - p[1]) / ratio};
}

std::vector<Vec3> SceneView::subject(Vec3& from) const {
  const CameraSpec& spec = scene_->scene.camera;
  const RigidTransform& to_world = scene_->camera.to_world();
  const Vec3 axis = normalize(spec.look_direction), right = normalize(cross(axis, spec.up)),
             up = cross(right, axis);
  const auto camera_corners = [&] {
    const double half = 0.5 * std::max(scene_->camera.lens_first_order().entrance_pupil_diameter,
                                       spec.sensor.size().x);
    std::vector<Vec3> points;
    for (const double x : {-half, half})
      for (const double y : {-half, half})
        for (const double z : {0.0, scene_->camera.sensor()})
          points.push_back(to_world.point({x, y, z}));
    return points;
  };
  std::array<double, 6> flame{};
  if (geometry_->flame) geometry_->flame->GetBounds(flame.data());
  std::vector<Vec3> points;
  switch (part_) {
    case Part::scene:
      points = camera_corners();
      if (geometry_->flame)
        for (const Vec3 p : views::corners(flame)) points.push_back(p);
      for (const CameraSpec& other : others_) points.push_back(other.position);
      from = 0.3 * axis - 1.0 * right + 0.35 * up;
      break;
    case Part::flame:
      points = geometry_->flame ? views::corners(flame) : camera_corners();
      from = -0.55 * axis - 0.8 * right + 0.2 * up;
      break;
    case Part::camera:
      points = camera_corners();
      from = 0.35 * axis - 1.0 * right + 0.35 * up;
      break;
    case Part::array:
    case Part::pixel: {
      std::array<double, 2> pixel{0.5 * spec.sensor.columns, 0.5 * spec.sensor.rows};
      if (rays_ && rays_->selection.kind == Selection::Kind::pixel)
        pixel = {rays_->selection.column + 0.5, rays_->selection.row + 0.5};
      const Vec2 place = scene_->camera.sensor_point(pixel[0], pixel[1]);
      const double pitch = spec.array.present ? spec.array.pitch : 10 * spec.sensor.pixel_pitch;
      const double half = (part_ == Part::array ? 2.5 : 0.75) * pitch;
      const double depth =
          spec.array.present ? scene_->camera.array_front() - scene_->camera.sensor() : 4 * half;
      for (const double x : {-half, half})
        for (const double y : {-half, half})
          for (const double z : {0.0, depth})
            points.push_back(
                to_world.point({place.x + x, place.y + y, scene_->camera.sensor() + z}));
      from = 0.75 * axis - 0.8 * right + 0.55 * up;
      break;
    }
  }
  return points;
}

std::vector<Vec3> SceneView::drawn_subject(Vec3& from) const {
  std::vector<Vec3> points = subject(from);
  for (Vec3& point : points) point = schematic_.place(point);
  return points;
}

void SceneView::aim() {
  if (!scene_ || !geometry_) return;
  const CameraSpec& spec = scene_->scene.camera;
  const Vec3 axis = normalize(spec.look_direction), right = normalize(cross(axis, spec.up)),
             up = cross(right, axis);
  Vec3 from;
  const std::vector<Vec3> points = drawn_subject(from);
  const double aspect = static_cast<double>(std::max(1, view_->widget->width())) /
                        std::max(1, view_->widget->height());
  views::look_at(points, -from, up, aspect, 10, *view_->renderer);
  aimed_ = true;
  view_->renderer->GetActiveCamera()->GetPosition(aimed_from_.data());
}

/// After a change the view goes where its subject went. Somebody who turned it keeps his direction
/// and his distance as long as the subject is seen.
void SceneView::follow(const std::array<double, 6>& before) {
  std::array<double, 6> now{};
  if (geometry_->flame) geometry_->flame->GetBounds(now.data());
  vtkCamera* const camera = view_->renderer->GetActiveCamera();
  if (part_ == Part::flame && geometry_->flame && before[1] > before[0] && now != before) {
    const auto middle = [](const std::array<double, 6>& box, std::size_t k) {
      return 0.5 * (box[2 * k] + box[2 * k + 1]);
    };
    std::array<double, 3> place{}, focus{};
    camera->GetPosition(place.data());
    camera->GetFocalPoint(focus.data());
    for (std::size_t k = 0; k < 3; ++k) {
      const double by = middle(now, k) - middle(before, k);
      place[k] += by;
      focus[k] += by;
      aimed_from_[k] += by;
    }
    camera->SetPosition(place.data());
    camera->SetFocalPoint(focus.data());
  }
  std::array<double, 3> place{};
  camera->GetPosition(place.data());
  Vec3 from;
  const std::vector<Vec3> points = subject(from);
  const QRectF room = view_->widget->rect();
  std::size_t seen = 0;
  for (const Vec3& point : points) seen += room.contains(to_widget(point)) ? 1U : 0U;
  if (place == aimed_from_ ? seen < points.size() : seen == 0) aim();
}

void SceneView::look_as(SceneView& other) {
  vtkCamera* const camera = other.view_->renderer->GetActiveCamera();
  view_->renderer->SetActiveCamera(camera);
  aimed_ = true;
  // Each draws anew when the other one turned it.
  for (const auto& [from, to] : {std::pair{this, &other}, {&other, this}}) {
    vtkCallbackCommand& moved = *to->view_->moved_elsewhere;
    moved.SetClientData(to);
    moved.SetCallback([](vtkObject*, unsigned long, void* view, void*) {
      static_cast<SceneView*>(view)->render();
    });
    from->view_->style->AddObserver(vtkCommand::InteractionEvent, &moved);
    from->view_->style->AddObserver(vtkCommand::EndInteractionEvent, &moved);
    from->view_->style->AddObserver(vtkCommand::MouseWheelForwardEvent, &moved);
    from->view_->style->AddObserver(vtkCommand::MouseWheelBackwardEvent, &moved);
  }
}

bool SceneView::eventFilter(QObject* object, QEvent* event) {
  if (object == view_->widget && move_->isChecked() &&
      (event->type() == QEvent::MouseButtonPress || event->type() == QEvent::MouseMove ||
       event->type() == QEvent::MouseButtonRelease)) {
    const auto* const mouse = static_cast<QMouseEvent*>(event);
    if (((mouse->buttons() | mouse->button()) & Qt::LeftButton) != 0 &&
        drag_handle(event->type(), pointer_place(mouse)))
      return true;
  }
  if (object == view_->widget && !measure_->isChecked()) {
    if (event->type() == QEvent::MouseButtonPress)
      pressed_ = pointer_place(static_cast<QMouseEvent*>(event));
    if (event->type() == QEvent::MouseButtonRelease) {
      const auto* const mouse = static_cast<QMouseEvent*>(event);
      const QPointF at = pointer_place(mouse);
      if (mouse->button() == Qt::LeftButton && (at - pressed_).manhattanLength() < 4) pick(at);
    }
  }
  if (object == view_->widget) {
    // VTK's own keys, from wire frames to pictures for red and green glasses, are not for users:
    // what is typed goes on to the window.
    if (event->type() == QEvent::KeyPress || event->type() == QEvent::KeyRelease) {
      event->ignore();
      return true;
    }
    if (event->type() == QEvent::MouseMove) {
      const auto* const mouse = static_cast<QMouseEvent*>(event);
      if (mouse->buttons() == Qt::NoButton) emit pointed(target_at(pointer_place(mouse)));
    }
    if (event->type() == QEvent::Leave) emit pointed({});
  }
  return QWidget::eventFilter(object, event);
}

Selection SceneView::target_at(const QPointF& place) const {
  if (!scene_) return {};
  const double ratio = view_->widget->devicePixelRatioF();
  const int* const size = view_->renderer->GetSize();
  const auto world_at = [&](double depth) {
    view_->renderer->SetDisplayPoint(place.x() * ratio, size[1] - 1 - place.y() * ratio, depth);
    view_->renderer->DisplayToWorld();
    const double* const p = view_->renderer->GetWorldPoint();
    return Vec3{p[0] / p[3], p[1] / p[3], p[2] / p[3]};
  };
  const Vec3 near = world_at(0), far = world_at(0.5);
  const Vec3 way = normalize(far - near);
  if (is_close()) return target_of(*scene_, {near, way}, Targets::microlenses);
  if (part_ == Part::camera) return target_of(*scene_, {near, way}, Targets::sensor);
  if (schematic_.is_to_scale()) return target_of(*scene_, {near, way}, Targets::flame);
  // Flame and sensor are each moved as a whole: so is the line of sight that meets them.
  const auto moved = [&](const Vec3& part) {
    return Ray{near - (schematic_.place(part) - part), way};
  };
  const Box box = scene_->medium ? scene_->medium->bounds() : Box{};
  const Selection flame = target_of(*scene_, moved(0.5 * (box.lower + box.upper)), Targets::flame);
  if (flame.kind == Selection::Kind::point) return flame;
  return target_of(*scene_, moved(scene_->camera.to_world().point({0, 0, scene_->camera.sensor()})),
                   Targets::sensor);
}

void SceneView::pick(const QPointF& place) {
  const Selection target = target_at(place);
  switch (target.kind) {
    case Selection::Kind::none:
      break;
    case Selection::Kind::point:
      emit point_picked(target.point);
      break;
    case Selection::Kind::microlens:
      emit lens_picked(target.lens);
      break;
    case Selection::Kind::pixel:
      emit pixel_picked(target.column, target.row);
      break;
  }
}

}  // namespace plenoflame::desktop
