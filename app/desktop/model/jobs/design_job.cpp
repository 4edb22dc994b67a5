#include "model/jobs/design_job.h"

#include "plenoflame/base/error.h"
#include "plenoflame/scene/design_report.h"
#include "plenoflame/scene/glass_indices.h"

namespace plenoflame::desktop {

DesignResult design_result(const Scene& given, bool traced) {
  Scene scene = given;
  set_indices(scene);
  std::vector<std::string> warnings;
  const Camera camera(scene.camera, &warnings);
  DesignResult out;
  out.complete = traced;
  out.figures = traced ? design(camera) : first_order_design(camera);
  warnings.insert(warnings.end(), out.figures.warnings.begin(), out.figures.warnings.end());
  for (const std::string& warning : warnings) out.warnings << QString::fromStdString(warning);
  if (traced) out.resolution = design_curve(camera, scene);
  Report report;
  add_design(camera, out.figures, out.resolution, report);
  out.lines = report.lines();
  return out;
}

DesignJob::DesignJob(Document& document, QObject* parent) : QObject(parent), document_(document) {
  connect(&document_, &Document::scene_changed, this, [this](const SceneChanges& changes) {
    if (changes.camera || changes.channels) request();
  });
}

void DesignJob::request() {
  const unsigned number = ++newest_;
  if (!document_.is_valid()) {
    task_.cancel();
    return;
  }
  task_.request(
      [this, number, scene = document_.scene_of_camera().scene](const std::stop_token& stop) {
        const auto show = [&](bool traced) {
          auto result = std::make_shared<const DesignResult>(design_result(scene, traced));
          post(this, [this, number, result] {
            if (number != newest_) return;
            result_ = result;
            emit result_changed();
          });
        };
        try {
          show(false);
          if (!stop.stop_requested()) show(true);
        } catch (const std::exception& error) {
          const std::string message = error.what();
          post(this, [this, number, message] {
            if (number == newest_) emit failed(QString::fromStdString(message));
          });
        }
      });
}

}  // namespace plenoflame::desktop
