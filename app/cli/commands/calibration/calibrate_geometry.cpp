#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>

#include "commands/add_option.h"
#include "commands/calibration/calibrate.h"
#include "commands/calibration/calibration_options.h"
#include "commands/scene_input.h"
#include "commands/setting_options.h"
#include "file_set.h"
#include "outputs.h"
#include "plenoflame/image/atomic_file.h"
#include "plot.h"
#include "pose_calibration.h"
#include "run.h"
#include "terminal.h"

namespace plenoflame::cli {
namespace {

struct GeometryArguments : CalibrationArguments {
  GeometryRequest request;
  std::string output, residuals, plot, poses;
};

/// The residuals: of each corner, and outwards against the distance from the middle, in which
/// distortion would show.
std::vector<Plot> residual_plots(const GeometryCalibration& found,
                                 const std::vector<CornerObservation>& corners) {
  Plot scatter, field;
  scatter.title = "What the fit leaves of each corner";
  scatter.x_label = "right [pixel]";
  scatter.y_label = "down [pixel]";
  scatter.equal_scales = true;
  field.title = "Outwards, over the picture";
  field.x_label = "from the middle of the picture [pixel]";
  field.y_label = "outwards [pixel]";
  const SensorSpec& sensor = found.camera.sensor;
  const Vec2 middle{0.5 * sensor.columns, 0.5 * sensor.rows};
  PlotSeries series;
  series.name = "observed - predicted";
  series.colour = plot_colour(0);
  series.style = PlotStyle::marks;
  PlotSeries outwards = series;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec2 rest = found.residuals[i], away = corners[i].pixel - middle;
    if (!std::isfinite(rest.x)) continue;
    series.points.emplace_back(rest.x, rest.y);
    if (length(away) > 0)
      outwards.points.emplace_back(length(away), dot(rest, away) / length(away));
  }
  scatter.series.push_back(series);
  field.series.push_back(outwards);
  for (Plot* plot : {&scatter, &field}) plot->log_x = plot->log_y = false;
  return {scatter, field};
}

int run_geometry(const GeometryArguments& arguments, const Execution& execution) {
  const SceneDocument start = read_camera_scene(arguments.camera, arguments.set, arguments.which);
  const FoundGeometry found = calibrate_geometry(arguments.request, start, execution);
  Scene scene = start.scene;
  scene.camera = found.fit.camera;
  Report report;
  report.add("camera", arguments.output, "camera", arguments.output);
  report.add_all(found.report);
  FileSet files;
  files.write(arguments.output, [&](const std::string& name) { write_scene_file(name, scene); });
  const auto write_table = [&](const std::string& path, const std::string& table) {
    if (!path.empty()) files.write(path, [&](const std::string& name) { write_file(name, table); });
  };
  write_table(arguments.residuals, found.residuals);
  write_table(arguments.poses, found.poses);
  if (!arguments.plot.empty()) write_plot(arguments.plot, residual_plots(found.fit, found.corners));
  files.commit();
  print(report, arguments.json);
  return kSuccess;
}

}  // namespace

void add_calibrate_geometry(CLI::App& calibrate, const Registry& registry) {
  auto a = std::make_shared<GeometryArguments>();
  CLI::App& command =
      *calibrate.add_subcommand("geometry",
                                "Distances, focal length and decentre from corners of a board that "
                                "was seen in several poses");
  command.footer(
      "Example:\n"
      "  plenoflame calibrate geometry corners.csv --camera camera.toml --centres centres.csv \\\n"
      "    -o calibrated.toml --plot residuals.png");
  command
      .add_option("CORNERS", a->request.corners,
                  "Table (.csv): pose,x,y,column,row[,q,r[,error,blur,blur_error]]; x, y on the "
                  "board [m], pixel (0, 0) at the picture's corner, q, r the microlens")
      ->required();
  add_camera_options(command, *a, "The camera to start with: nominal values will do");
  add_option(command, "-o,--output", a->output, "FILE.toml",
             "The scene file with the camera that was found")
      ->check(written({".toml"}))
      ->required();
  add_settings<GeometryRequest>(command, a->request);
  add_option(command, "--residuals", a->residuals, "FILE.csv",
             "Table of what the fit leaves of each corner")
      ->check(written());
  add_option(command, "--poses", a->poses, "FILE.csv", "Table of the boards' places")
      ->check(written());
  add_option(command, "--plot", a->plot, "FILE.svg|png", "Picture of what the fit leaves")
      ->check(written());
  finish_calibration(command, registry, a, CalibrationInput::tables,
                     [a](const Execution& execution) { return run_geometry(*a, execution); });
}

}  // namespace plenoflame::cli
