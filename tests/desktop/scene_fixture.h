// A small scene in the window, and where its things are seen.
#pragma once
#include <QAction>

#include "plenoflame/base/error.h"
#include "widgets/scene/scene_view.h"
#include "widgets/scene/section_view.h"
#include "window_fixture.h"

namespace plenoflame::desktop::test {

class SceneFixture : public WindowFixture {
 protected:
  SceneView& view() { return window_->scene_view(); }
  /// The section, and the view in three dimensions: one takes the place of the other.
  SectionView& section() {
    show_section(true);
    return window_->section_view();
  }
  QWidget* scene3d() {
    show_section(false);
    return child<QWidget>("scene3d");
  }
  void show_section(bool on) {
    auto* const mode = child<QAction>("viewSection");
    for (auto* button : window_->findChildren<QToolButton*>()) {
      if (mode->isChecked() == on || button->defaultAction() != mode) continue;
      QTest::mouseClick(button, Qt::LeftButton);
      QTest::qWait(50);  // it gets its place
    }
  }
  const Selection& selection() { return session().document().selection(); }
  const CompiledScene& scene() { return *session().compiler().compiled(); }
  bool open_example(const char* name) {
    return window_->open_example(name) && settled() &&
           until([this] { return view().flame_temperatures()[1] > 0; });
  }
  /// The flame in colours of its temperature, with their bar.
  void draw_temperatures() {
    FlameLook look;
    look.drawing = FlameDrawing::emission;
    session().document().set_look(look, "test");
  }
  /// A part of the 3-D view by its key, and drawn.
  bool part(Qt::Key key) {
    press(key, Qt::ControlModifier);
    return settled();
  }
  /// A point of the camera's frame in the world: z towards the scene, x right, y down.
  Vec3 world(Vec3 camera) {
    const CameraSpec& spec = session().document().scene().camera;
    const Vec3 axis = normalize(spec.look_direction), right = normalize(cross(axis, spec.up)),
               up = cross(right, axis);
    return spec.position + camera.z * axis + camera.x * right - camera.y * up;
  }
  /// Middle of a pixel: x = (W/2 - column) pitch, y = (H/2 - row) pitch.
  Vec3 pixel_in_world(int column, int row) {
    const SensorSpec& sensor = session().document().scene().camera.sensor;
    return world({(0.5 * sensor.columns - column - 0.5) * sensor.pixel_pitch,
                  (0.5 * sensor.rows - row - 0.5) * sensor.pixel_pitch, scene().camera.sensor()});
  }
  QPoint seen_at(Vec3 point) { return view().to_widget(point).toPoint(); }
  static void wheel(QWidget* widget, QPointF at, int steps, int sideways = 0) {
    QWheelEvent event(at, widget->mapToGlobal(at.toPoint()), {}, {120 * sideways, 120 * steps},
                      Qt::NoButton, {}, Qt::NoScrollPhase, false);
    QApplication::sendEvent(widget, &event);
  }
  void hover(QWidget* widget, QPointF at) { mouse(widget, QEvent::MouseMove, at, Qt::NoButton); }
};

}  // namespace plenoflame::desktop::test
