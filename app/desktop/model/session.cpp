#include "model/session.h"

namespace plenoflame::desktop {
Session::Session(QObject* parent)
    : QObject(parent), compiler_(document_), rays_(document_, compiler_), design_(document_) {
  later_.setSingleShot(true);
  connect(&later_, &QTimer::timeout, this, &Session::update_light_field);
  connect(&document_, &Document::scene_changed, this, [this](const SceneChanges& changes) {
    // An image of another scene is no use to anybody.
    if (changes.image()) render_.stop();
  });
  connect(&compiler_, &SceneCompiler::compiled_changed, this, &Session::on_compiled);
  connect(&compiler_, &SceneCompiler::failed, this,
          [this](const QString& message) { emit failed("scene", message); });
  connect(&compiler_, &SceneCompiler::warned, this, &Session::warned);
  connect(&render_, &RenderJob::image, this,
          [this](const std::shared_ptr<const LightField>& field) { document_.set_image(field); });
  connect(&render_, &RenderJob::failed, this,
          [this](const QString& message) { emit failed("render", message); });
  connect(&render_, &RenderJob::state_changed, this, [this] {
    if (render_.state() == RenderJob::State::finished ||
        render_.state() == RenderJob::State::paused)
      update_light_field();
  });
  connect(&rays_, &RaySelector::failed, this,
          [this](const QString& message) { emit failed("rays", message); });
  connect(&light_field_, &LightFieldJobs::failed, this,
          [this](const QString& message) { emit failed("light field", message); });
  connect(&design_, &DesignJob::failed, this,
          [this](const QString& message) { emit failed("design", message); });
  connect(&document_, &Document::image_changed, this, [this] {
    // While an image is being refined, views are made of whole passes only.
    const auto& image = document_.image();
    if (render_.state() != RenderJob::State::running || (image && image->complete)) later_.start(0);
  });
}

void Session::set_auto_render(bool on) {
  auto_render_ = on;
  if (on && !document_.image_is_current() && render_.state() == RenderJob::State::idle)
    start_render();
}

void Session::set_outlines_wanted(bool on) {
  if (on == outlines_wanted_) return;
  outlines_wanted_ = on;
  if (on) update_light_field();
}

void Session::set_views_wanted(bool on) {
  if (on == views_wanted_) return;
  views_wanted_ = on;
  if (on) update_light_field();
}

void Session::start_render() {
  if (!compiler_.compiled()) return;
  if (!compiler_.is_current()) {
    start_when_compiled_ = true;
    return;
  }
  render_.start(compiler_.compiled(), threads_);
}

void Session::on_compiled(const SceneChanges& changes) {
  const bool wanted = start_when_compiled_ || (auto_render_ && changes.image());
  start_when_compiled_ = false;
  // An image that came with the scene waited for its camera; one of an earlier camera is no use.
  if (document_.image_is_current())
    update_light_field();
  else if ((outlines_wanted_ || views_wanted_) && changes.camera)
    light_field_.set_camera(compiler_.compiled()->scene.camera);
  if (wanted && !document_.image_is_current()) render_.start(compiler_.compiled(), threads_);
}

void Session::update_light_field() {
  if (!compiler_.compiled() || !(outlines_wanted_ || views_wanted_)) return;
  const CameraSpec& camera = compiler_.compiled()->scene.camera;
  if (!views_wanted_) return light_field_.set_camera(camera);
  if (!document_.image()) {
    light_field_.clear();
    light_field_.set_camera(camera);
    return;
  }
  const LightField& field = *document_.image();
  // While a new camera is being compiled the image is still the old one's.
  if (field.sensor_width != camera.sensor.columns || field.sensor_height != camera.sensor.rows)
    return;
  light_field_.set_image(document_.image(), camera);
}

}  // namespace plenoflame::desktop
