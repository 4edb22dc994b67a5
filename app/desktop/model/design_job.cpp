#include "model/design_job.h"

#include "commands/design_report.h"
#include "plenoflame/base/error.h"
#include "plenoflame/scene/glass_indices.h"

namespace plenoflame::desktop {

DesignResult design_result(const Scene& given, bool traced) {
  constexpr int kCurvePoints = 61;  // as `plenoflame design` takes
  Scene scene = given;
  set_indices(scene);
  std::vector<std::string> warnings;
  const Camera camera(scene.camera, &warnings);
  DesignResult out;
  out.complete = traced;
  out.figures = traced ? design(camera) : first_order_design(camera);
  warnings.insert(warnings.end(), out.figures.warnings.begin(), out.figures.warnings.end());
  for (const std::string& warning : warnings) out.warnings << QString::fromStdString(warning);
  cli::Report report;
  cli::add_main_lens(out.figures, report);
  cli::add_types(camera, out.figures, report);
  cli::add_array(camera, out.figures, report);
  if (traced) {
    const ChannelSpec& channel = scene.channels.front();
    out.resolution = resolution_curve(camera, kCurvePoints,
                                      channel.kind == ChannelKind::band ? channel.wavelength : 0);
    cli::add_resolution(out.resolution, out.figures, report);
    cli::add_spots(out.figures, report);
  }
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
  task_.request([this, number, scene = document_.scene()](const std::stop_token& stop) {
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
