#include "model/session.h"

namespace plenoflame::desktop {
Session::Session(QObject* parent)
    : QObject(parent),
      compiler_(document_),
      rays_(document_, compiler_),
      design_(document_),
      lens_(document_),
      measured_(document_) {
  later_.setSingleShot(true);
  connect(&later_, &QTimer::timeout, this, &Session::update_light_field);
  connect(&document_, &Document::scene_changed, this, [this](const SceneChanges& changes) {
    // An image of another scene is no use to anybody.
    if (!changes.image()) return;
    render_.stop();
    viewed_is_old_ = views_are_old_ = true;
    image_is_other_ |= changes.compiled() || changes.sampling;
    if (!changes.opened) return;
    render_.clear();
    light_field_.clear();
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
    // A picture that was broken off is seen in the views, too: nothing better comes by itself.
    if (render_.state() != RenderJob::State::running && document_.image_is_current()) take_image();
  });
  connect(&rays_, &RaySelector::failed, this,
          [this](const QString& message) { emit failed("rays", message); });
  connect(&light_field_, &LightFieldJobs::failed, this,
          [this](const QString& message) { emit failed("light field", message); });
  connect(&light_field_, &LightFieldJobs::views_changed, this, [this] {
    if (!viewed_is_old_) views_are_old_ = false;
  });
  connect(&design_, &DesignJob::failed, this,
          [this](const QString& message) { emit failed("design", message); });
  connect(&document_, &Document::image_changed, this, &Session::on_image);
}

void Session::on_image() {
  const auto& image = document_.image();
  image_is_other_ = false;
  // While an image is being refined, views are made of whole passes only.
  const bool refined = render_.state() == RenderJob::State::running && image && !image->complete;
  if (!refined) return take_image();
  if (viewed_is_old_) viewed_ = nullptr;
}

/// Views are of the present image, once its camera is known.
void Session::take_image() {
  const bool known = document_.image_is_current() && compiler_.is_current();
  viewed_ = known ? document_.image() : nullptr;
  if (known) {
    viewed_camera_ = compiler_.compiled()->scene.camera;
    viewed_windows_ = compiler_.compiled()->scene.windows;
  }
  viewed_is_old_ = false;
  later_.start(0);
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
  if (!compiler_.is_current()) {
    start_when_compiled_ = !document_.is_empty();
    compiler_.retry();
    return;
  }
  render_now();
}

void Session::render_now() {
  render_.start(compiler_.compiled(), threads_, bettered());
}

/// The picture that is there, where it is one of the present scene with any number of samples.
std::shared_ptr<const LightField> Session::bettered() const {
  const auto& image = document_.image();
  const Scene& scene = compiler_.compiled()->scene;
  const SensorSpec& sensor = scene.camera.sensor;
  if (!image || image_is_other_ || image->seed != scene.render.seed) return nullptr;
  const bool whole = image->window.width == sensor.columns && image->window.height == sensor.rows;
  return whole && image->channels.size() == scene.channels.size() ? image : nullptr;
}

void Session::on_compiled(const SceneChanges& changes) {
  const bool wanted = start_when_compiled_ || (auto_render_ && changes.image());
  start_when_compiled_ = false;
  // An image that came with the scene waited for its camera; one of an earlier camera is no use.
  if (document_.image_is_current())
    on_image();
  else if ((outlines_wanted_ || views_wanted_) && changes.camera)
    light_field_.set_camera(compiler_.compiled()->scene.camera,
                            compiler_.compiled()->scene.windows);
  if (wanted && !document_.image_is_current()) render_now();
}

void Session::update_light_field() {
  if (!compiler_.compiled() || !(outlines_wanted_ || views_wanted_)) return;
  if (views_wanted_ && viewed_)
    return light_field_.set_image(viewed_, viewed_camera_, viewed_windows_, views_are_old_);
  if (views_wanted_ && !document_.image()) light_field_.clear();
  light_field_.set_camera(compiler_.compiled()->scene.camera, compiler_.compiled()->scene.windows);
}

}  // namespace plenoflame::desktop
