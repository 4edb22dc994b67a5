#include "design_json.h"

#include "commands/design_report.h"
#include "plenoflame/camera/design.h"
#include "plenoflame/camera/resolution.h"
#include "report.h"

namespace plenoflame::pipeline {

std::string design_json(const Scene& scene) {
  constexpr int kCurvePoints = 61;  // as `plenoflame design` takes
  std::vector<std::string> warnings;
  const Camera camera(scene.camera, &warnings);
  const CameraDesign figures = design(camera);
  warnings.insert(warnings.end(), figures.warnings.begin(), figures.warnings.end());
  const ChannelSpec& channel = scene.channels.front();
  const auto curve = resolution_curve(camera, kCurvePoints,
                                      channel.kind == ChannelKind::band ? channel.wavelength : 0);
  cli::Report report;
  cli::add_main_lens(figures, report);
  cli::add_types(camera, figures, report);
  cli::add_array(camera, figures, report);
  cli::add_resolution(curve, figures, report);
  cli::add_spots(figures, report);
  report.add_json("warnings", warnings);
  return report.json_text();
}

}  // namespace plenoflame::pipeline
