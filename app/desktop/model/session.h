#pragma once
#include <QElapsedTimer>
#include <QObject>
#include <QTimer>

#include "model/document.h"
#include "model/jobs/design_job.h"
#include "model/jobs/lens_job.h"
#include "model/jobs/light_field_jobs.h"
#include "model/jobs/measured_picture.h"
#include "model/jobs/ray_selector.h"
#include "model/jobs/render_job.h"
#include "model/jobs/scene_compiler.h"

namespace plenoflame::desktop {

/// A document with everything that is computed from it, each part anew when what it depends on has
/// changed. The window shows it; nothing here knows of the window.
class Session : public QObject {
  Q_OBJECT
 public:
  explicit Session(QObject* parent = nullptr);

  Document& document() { return document_; }
  SceneCompiler& compiler() { return compiler_; }
  RenderJob& render() { return render_; }
  RaySelector& rays() { return rays_; }
  LightFieldJobs& light_field() { return light_field_; }
  DesignJob& design() { return design_; }
  LensJob& lens() { return lens_; }
  MeasuredPicture& measured() { return measured_; }

  /// True if the image follows every change by itself (default).
  bool auto_render() const { return auto_render_; }
  void set_auto_render(bool on);
  /// Requests the places of micro-images, and views, which cost much more time.
  void set_outlines_wanted(bool on);
  void set_views_wanted(bool on);
  /// Renders the present scene from the beginning.
  void start_render();
  /// True if the views are of the scene before the last change.
  bool views_are_old() const { return views_are_old_ && light_field_.views(); }
  /// True if nothing is being computed beside the picture and the rays, which say so themselves.
  bool at_rest() const { return !design_.busy() && !lens_.busy() && !light_field_.busy(); }
  /// Threads for rendering; 0: one per processor.
  void set_threads(int threads) { threads_ = threads; }

 signals:
  /// Something could not be computed. @param what "render", "rays", ...
  void failed(const QString& what, const QString& message);
  void warned(const QString& message);

 private:
  void on_compiled(const SceneChanges& changes);
  void on_image();
  void take_image();
  std::shared_ptr<const LightField> bettered() const;
  void render_now();
  void update_light_field();

  Document document_;
  SceneCompiler compiler_;
  RenderJob render_;
  RaySelector rays_;
  LightFieldJobs light_field_;
  DesignJob design_;
  LensJob lens_;
  MeasuredPicture measured_;
  /// The image that views are made of, and the camera that took it: no picture that is being
  /// refined.
  std::shared_ptr<const LightField> viewed_;
  CameraSpec viewed_camera_;
  std::vector<WindowSpec> viewed_windows_;
  bool viewed_is_old_ = false;  ///< of an earlier scene
  bool views_are_old_ = false;  ///< of an earlier scene than the document's
  bool image_is_other_ = true;  ///< of a scene that differs by more than its number of samples
  bool auto_render_ = true, outlines_wanted_ = false, views_wanted_ = false,
       start_when_compiled_ = false;
  int threads_ = 0;
  QTimer later_;
};

}  // namespace plenoflame::desktop
