#include "plenoflame/camera/design.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>

#include "commands/commands.h"
#include "commands/design_array.h"
#include "commands/design_report.h"
#include "commands/scene_input.h"
#include "options.h"
#include "plenoflame/base/error.h"
#include "run.h"

namespace plenoflame::cli {
namespace {

constexpr int kCurvePoints = 61;

struct Settings {
  std::string scene;
  bool json = false;
  std::string plots;
  std::string format = "png";
  ArrayTask array;
};

void write_plots(const Settings& settings, const Camera& camera, const CameraDesign& d,
                 const std::vector<ResolutionPoint>& curve, const std::vector<SolvedType>& solved) {
  const std::filesystem::path folder(settings.plots);
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw FileError(settings.plots + ": " + error.message());
  const auto write = [&](const std::string& name, const std::vector<Plot>& plots, int columns) {
    if (!plots.empty())
      write_plot((folder / (name + "." + settings.format)).string(), plots, columns);
  };
  if (!curve.empty()) write("resolution", {resolution_plot(curve, d)}, 1);
  write("spots", spot_plots(camera, d), 2);
  const ArraySpec& array = camera.spec().array;
  const bool has_faces = array.present && !(std::isinf(array.types.front().radius_front) &&
                                            std::isinf(array.types.front().radius_back));
  if (has_faces) write("microlens", microlens_plots(array, solved, settings.array.freedom), 3);
}

int run_design(const Settings& settings) {
  const ArrayTask& task = settings.array;
  if (!task.output.empty() && task.freedom.empty())
    throw UsageError("--output: there is nothing to write without --solve");
  std::vector<std::string> warnings;
  const Scene scene = read_valid_scene(settings.scene, &warnings).scene;
  const Camera camera(scene.camera);
  const CameraDesign d = design(camera);
  warnings.insert(warnings.end(), d.warnings.begin(), d.warnings.end());
  for (const std::string& warning : warnings)
    std::cerr << "plenoflame: warning: " << warning << '\n';
  const ChannelSpec& channel = scene.channels.front();
  const auto curve = resolution_curve(camera, kCurvePoints,
                                      channel.kind == ChannelKind::band ? channel.wavelength : 0);
  Report report;
  add_main_lens(d, report);
  add_types(camera, d, report);
  add_array(camera, d, report);
  add_resolution(curve, d, report);
  add_spots(d, report);
  report.add_json("warnings", warnings);
  std::vector<SolvedType> solved;
  if (!task.freedom.empty()) solved = solve_for_array(task, scene, report);
  if (!task.output.empty()) {
    check_not_overwritten("--output", task.output, settings.scene);
    write_scene_file(task.output, with_solved_array(scene, solved, freedom_named(task.freedom)));
  }
  if (!settings.plots.empty()) write_plots(settings, camera, d, curve, solved);
  report.print(settings.json);
  return kSuccess;
}

}  // namespace

void register_design(const Registry& registry) {
  auto settings = std::make_shared<Settings>();
  CLI::App& command =
      add_command(registry, "design", "Work out what a camera can do: pupils, depth of field, blur",
                  "plenoflame design examples/paper-flame-1m.toml --plots out");
  command.add_option("SCENE", settings->scene, "Scene file (.toml)")->required();
  command.add_flag("--json", settings->json, "Print the figures as JSON");
  command.add_option("--plots", settings->plots,
                     "Folder for plots: effective resolution against distance, spots, microlenses");
  command.add_option("--format", settings->format, "Of the plots")
      ->check(CLI::IsMember({"png", "svg"}))
      ->capture_default_str();
  command
      .add_option(
          "--solve", settings->array.freedom,
          "Find further microlens types whose depths of field join the first one's; free is "
          "their index, the radius of their faces, or their thickness")
      ->check(CLI::IsMember({"index", "radius", "thickness"}));
  command.add_option("--types", settings->array.types, "With --solve: number of types")
      ->check(CLI::Range(1, 3))
      ->capture_default_str();
  command.add_option("--greatest-index", settings->array.index_limit, "With --solve")
      ->check(CLI::Range(1.0, 5.0))
      ->capture_default_str();
  command.add_option("--least-radius", settings->array.least_radius,
                     "With --solve: of the faces, with unit");
  command.add_option("--greatest-thickness", settings->array.greatest_thickness,
                     "With --solve, with unit");
  command.add_option("-o,--output", settings->array.output,
                     "With --solve: the scene with the types that were found (.toml)");
  on_chosen(command, registry, [settings] { return run_design(*settings); });
}

}  // namespace plenoflame::cli
