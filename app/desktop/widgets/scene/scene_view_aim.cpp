#include <vtkBoundingBox.h>
#include <vtkCamera.h>
#include <vtkPolyData.h>

#include <QAction>
#include <QMouseEvent>
#include <QWheelEvent>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "model/scene_target.h"
#include "picture_camera.h"
#include "widgets/controls/pointer.h"
#include "widgets/scene/scene_geometry.h"
#include "widgets/scene/scene_view_parts.h"

// Direction in which the 3-D view looks, and what is pointed at in it.
namespace plenoflame::desktop {

namespace {

/// Extent of the shown walls and floors, relative to the things in front of them.
constexpr double kGroundShare = 1.6;
constexpr int kRest = 150;          ///< [ms] after the last turn of the wheel
constexpr double kBarShare = 0.16;  ///< of the view's width, that the bar of colours takes

views::Subject subject_of(SceneView::Part part) {
  switch (part) {
    case SceneView::Part::scene:
      return views::Subject::scene;
    case SceneView::Part::flame:
      return views::Subject::flame;
    case SceneView::Part::camera:
      return views::Subject::camera;
    case SceneView::Part::array:
    case SceneView::Part::pixel:
      break;
  }
  return views::Subject::array;
}

std::vector<Vec3> corners_of(const vtkBoundingBox& box) {
  std::array<double, 6> bounds{};
  box.GetBounds(bounds.data());
  return views::corners(bounds);
}

}  // namespace

QPointF SceneView::drawn_to_widget(const Vec3& drawn) const {
  const double ratio = view_->widget->devicePixelRatioF();
  const int* const size = view_->renderer->GetSize();
  view_->renderer->SetWorldPoint(drawn.x, drawn.y, drawn.z, 1);
  view_->renderer->WorldToDisplay();
  const double* const p = view_->renderer->GetDisplayPoint();
  return {p[0] / ratio, (size[1] - 1 - p[1]) / ratio};
}

Vec3 SceneView::drawn_at(const QPointF& place, double depth) const {
  const double ratio = view_->widget->devicePixelRatioF();
  const int* const size = view_->renderer->GetSize();
  view_->renderer->SetDisplayPoint(place.x() * ratio, size[1] - 1 - place.y() * ratio, depth);
  view_->renderer->DisplayToWorld();
  const double* const p = view_->renderer->GetWorldPoint();
  return {p[0] / p[3], p[1] / p[3], p[2] / p[3]};
}

QPointF SceneView::to_widget(const Vec3& world) const {
  return drawn_to_widget(schematic_.place(world));
}

std::vector<QPointF> SceneView::other_cameras_seen() const {
  std::vector<QPointF> places;
  for (std::size_t i = 0; i < others_.size(); ++i)
    places.push_back(drawn_to_widget(schematic_of(i + 1).place(others_[i].position)));
  return places;
}

/// Adds the bodies, and walls and floors as far as they surround the points so far. These are the
/// background of a flame; whole walls would reduce it to a speck.
void SceneView::add_solids(std::vector<Vec3>& points) const {
  const views::SolidSurfaces& solids = geometry_->solids;
  vtkBoundingBox all = solids.all;
  if (!all.IsValid()) return;
  if (geometry_->flame || solids.bodies.IsValid()) {
    vtkBoundingBox around = solids.bodies;
    for (const Vec3& p : points) around.AddPoint(p.x, p.y, p.z);
    around.ScaleAboutCenter(kGroundShare);
    if (around.Intersects(all)) all.IntersectBox(around);
  }
  const std::vector<Vec3> corners = corners_of(all);
  points.insert(points.end(), corners.begin(), corners.end());
}

std::array<double, 2> SceneView::pixel() const {
  if (rays_ && rays_->selection.kind == Selection::Kind::pixel)
    return {rays_->selection.column + 0.5, rays_->selection.row + 0.5};
  const SensorSpec& sensor = geometry_->drawn.front().optics.spec().sensor;
  return {0.5 * sensor.columns, 0.5 * sensor.rows};
}

std::vector<Vec3> SceneView::drawn_subject(Vec3& from) const {
  const CameraSpec& spec = scene_->scene.camera;
  const RigidTransform& to_world = scene_->camera.to_world();
  const Vec3 axis = normalize(spec.look_direction), right = normalize(cross(axis, spec.up)),
             up = cross(right, axis);
  const views::SolidSurfaces& solids = geometry_->solids;
  from = views::way_to_eye(
      subject_of(part_), axis, right, up,
      {solids.all.IsValid() != 0, solids.bodies.IsValid() != 0, !others_.empty()});
  std::vector<Vec3> points, of_others;
  const auto add = [&](const std::vector<Vec3>& more) {
    points.insert(points.end(), more.begin(), more.end());
  };
  // Half a side and two ends of a box around a stretch of the axis, or of a line beside it.
  const auto add_box = [&](Vec2 middle, double half, double begin, double end) {
    for (const double x : {-half, half})
      for (const double y : {-half, half})
        for (const double z : {begin, end})
          points.push_back(to_world.point({middle.x + x, middle.y + y, z}));
  };
  const auto add_camera_box = [&] {
    add_box({}, 0.5 * geometry_->cameras.front().width, 0, scene_->camera.sensor());
    if (auto* const housing = housing_shown(0))
      add(corners_of(vtkBoundingBox(housing->GetBounds())));
  };
  switch (part_) {
    case Part::scene:
      add_camera_box();
      if (geometry_->flame) add(corners_of(vtkBoundingBox(geometry_->flame->GetBounds())));
      for (const std::vector<Vec3>& outline : geometry_->windows) add(outline);
      add_solids(points);
      for (std::size_t i = 0; i < others_.size() && i + 1 < geometry_->cameras.size(); ++i) {
        const CameraOnAxis& other = geometry_->cameras[i + 1];
        for (const double along : {other.sensor, 0.0})
          of_others.push_back(schematic_of(i + 1).place(other.position + along * other.axis));
      }
      break;
    case Part::flame: {
      vtkBoundingBox box = solids.bodies;
      if (geometry_->flame) box.AddBounds(geometry_->flame->GetBounds());
      if (!box.IsValid()) box = solids.all;  // nothing but planes
      if (box.IsValid())
        add(corners_of(box));
      else
        add_camera_box();
      break;
    }
    case Part::camera:
      add_camera_box();
      break;
    case Part::array:
    case Part::pixel: {
      const auto [column, row] = pixel();
      const double pitch = spec.array.present ? spec.array.pitch : 10 * spec.sensor.pixel_pitch;
      const double half = (part_ == Part::array ? 2.5 : 0.75) * pitch;
      const double sensor = scene_->camera.sensor();
      add_box(scene_->camera.sensor_point(column, row), half, sensor,
              spec.array.present ? scene_->camera.array_front() : sensor + 4 * half);
      break;
    }
  }
  for (Vec3& point : points) point = schematic_.place(point);
  add(of_others);
  return points;
}

void SceneView::look(const std::vector<Vec3>& drawn, const Vec3& direction, const Vec3& up) {
  const double aspect = static_cast<double>(std::max(1, view_->widget->width())) /
                        std::max(1, view_->widget->height());
  const double bar = shows_flame() && geometry_->flame && !shows_eye() ? kBarShare : 0;
  views::look_at(drawn, direction, up, (1 - bar) * aspect, 10, *view_->renderer);
  view_->renderer->GetActiveCamera()->SetWindowCenter(bar, 0);
  view_->renderer->GetActiveCamera()->GetPosition(aimed_from_.data());
  view_->renderer->GetActiveCamera()->GetViewUp(aimed_up_.data());
  aimed_ = true;
}

void SceneView::aim() {
  if (!scene_ || !geometry_) return;
  const CameraSpec& spec = scene_->scene.camera;
  const Vec3 axis = normalize(spec.look_direction), right = normalize(cross(axis, spec.up)),
             up = cross(right, axis);
  Vec3 from;
  const std::vector<Vec3> points = drawn_subject(from);
  look(points, -from, up);
  along_axis_ = false;
}

bool SceneView::is_as_aimed() const {
  std::array<double, 3> place{}, up{};
  view_->renderer->GetActiveCamera()->GetPosition(place.data());
  view_->renderer->GetActiveCamera()->GetViewUp(up.data());
  return aimed_ && place == aimed_from_ && up == aimed_up_;
}

/// The distance is that of the widget's size: panels that get higher beside it, or a larger window,
/// change it. Somebody who turned the view or came closer keeps what he has.
void SceneView::fit_to_size() {
  if (!scene_ || !geometry_ || !is_as_aimed() || dragged_ >= 0) return;
  if (!along_axis_) {
    aim();
    return;
  }
  std::array<double, 3> ahead{}, up{};
  view_->renderer->GetActiveCamera()->GetDirectionOfProjection(ahead.data());
  view_->renderer->GetActiveCamera()->GetViewUp(up.data());
  Vec3 from;
  look(drawn_subject(from), {ahead[0], ahead[1], ahead[2]}, {up[0], up[1], up[2]});
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
  Vec3 from;
  const std::vector<Vec3> points = drawn_subject(from);
  const QRectF room = view_->widget->rect();
  std::size_t seen = 0;
  for (const Vec3& point : points) seen += room.contains(drawn_to_widget(point)) ? 1U : 0U;
  if (is_as_aimed() && !along_axis_ ? seen < points.size() : seen == 0) aim();
}

void SceneView::look_as(SceneView& other) {
  vtkCamera* const camera = other.view_->renderer->GetActiveCamera();
  view_->renderer->SetActiveCamera(camera);
  aimed_ = true;
  // Each view redraws when the other one has turned it.
  for (const auto& [from, to] : {std::pair{this, &other}, {&other, this}}) {
    vtkCallbackCommand& moved = *to->view_->moved_elsewhere;
    moved.SetClientData(to);
    moved.SetCallback([](vtkObject*, unsigned long, void* view, void*) {
      static_cast<SceneView*>(view)->render();
    });
    from->view_->style->AddObserver(vtkCommand::InteractionEvent, &moved);
    from->view_->style->AddObserver(vtkCommand::EndInteractionEvent, &moved);
  }
}

bool SceneView::eventFilter(QObject* object, QEvent* event) {
  if (object == view_->widget && event->type() == QEvent::Resize) {
    fit_to_size();
    if (section_) section_->resize(view_->widget->size());  // pictures of it are made unseen, too
  }
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
    if (event->type() == QEvent::Wheel) {
      const auto* const wheel = static_cast<QWheelEvent*>(event);
      const int turn = wheel->angleDelta().y();
      if (turn != 0) zoom(wheel->position(), std::pow(2.0, turn / 240.0));
      return true;
    }
    // VTK's own keys, from wire frames to pictures for red and green glasses, are not for users:
    // key presses go to the window.
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

Vec3 SceneView::thing_at(const QPointF& place) const {
  vtkRenderer& renderer = *view_->renderer;
  vtkCamera& camera = *renderer.GetActiveCamera();
  const Vec3 eye = vec(camera.GetPosition()), ahead = vec(camera.GetDirectionOfProjection());
  const Vec3 way = normalize(drawn_at(place, 0.5) - eye);
  const auto at_depth = [&](double depth) { return eye + depth / dot(way, ahead) * way; };
  const double ratio = view_->widget->devicePixelRatioF();
  const double surface =
      renderer.GetZ(static_cast<int>(place.x() * ratio),
                    renderer.GetSize()[1] - 1 - static_cast<int>(place.y() * ratio));
  double depth = surface < 1 ? dot(drawn_at(place, surface) - eye, ahead) : 1e300;
  // Arrays and flames are transparent: they are no surfaces.
  for (std::size_t i = 0; geometry_ && i < geometry_->drawn.size(); ++i) {
    const Camera& optics = geometry_->drawn[i].optics;
    if (!optics.has_array()) continue;
    const RigidTransform inverse = optics.to_world().inverse();
    const Vec3 origin = inverse.point(eye - array_shift(optics, schematic_of(i))),
               along = inverse.direction(way);
    const double t = (optics.array_front() - origin.z) / along.z;
    const Vec3 p = origin + t * along;
    if (t > 0 && whole_array(optics).has({p.x, p.y})) depth = std::min(depth, t * dot(way, ahead));
  }
  if (geometry_ && geometry_->flame && shows_flame()) {
    vtkBoundingBox box(geometry_->flame->GetBounds());
    std::array<double, 3> centre{};
    box.GetCenter(centre.data());
    const Vec3 middle = schematic_.place(vec(centre.data()));
    const double of_flame = dot(middle - eye, ahead);
    const Vec3 p = at_depth(of_flame) - middle + vec(centre.data());
    if (of_flame > 0 && of_flame < depth && box.ContainsPoint(p.x, p.y, p.z)) depth = of_flame;
  }
  return at_depth(depth < 1e300 ? depth : camera.GetDistance());
}

void SceneView::zoom(const QPointF& place, double factor) {
  vtkCamera& camera = *view_->renderer->GetActiveCamera();
  const Vec3 ahead = vec(camera.GetDirectionOfProjection()), at = thing_at(place);
  const Vec3 eye = at - (1 / factor) * (at - vec(camera.GetPosition()));
  // The scale bar, and turning, are about the plane in which the thing is.
  const Vec3 middle = eye + dot(at - eye, ahead) * ahead;
  camera.SetPosition(eye.x, eye.y, eye.z);
  camera.SetFocalPoint(middle.x, middle.y, middle.z);
  view_->style->InvokeEvent(vtkCommand::InteractionEvent);  // for a view with the same camera
  view_->sort_glass(false);
  view_->window->Render();  // the next turn of the wheel asks for depths
  view_->rest.start(kRest);
}

Selection SceneView::target_at(const QPointF& place) const {
  if (!scene_) return {};
  const Vec3 near = drawn_at(place, 0), far = drawn_at(place, 0.5);
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
