#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <set>
#include <tuple>

#include "commands/add_option.h"
#include "commands/commands.h"
#include "commands/scene_input.h"
#include "medium_loader.h"
#include "options.h"
#include "outputs.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/report.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/render/pattern_images.h"
#include "run.h"
#include "terminal.h"

namespace plenoflame::cli {
namespace {

constexpr int kCornerRays = 4096;

struct CornersArguments {
  std::string scene, camera, output, rays;
  std::vector<std::string> set;
  bool json = false;
};

int run_corners(const CornersArguments& settings, const std::stop_token& stop) {
  const int rays =
      settings.rays.empty() ? kCornerRays : whole_number_option("--rays", settings.rays, 1);
  check_writable(settings.output);
  SceneDocument document = read_camera_scene(settings.scene, settings.set, settings.camera);
  document.scene.flames.clear();  // where a corner is does not depend on what burns
  Execution execution;
  const CompiledScene scene =
      compile(document, medium_loader(), execution, {}, {IssueCode::no_flame});
  std::vector<PatternImage> images;
  {
    execution.stop = stop;
    images = pattern_images(scene, rays, execution);
  }
  write_pattern_images(settings.output, scene, images);
  std::set<std::tuple<int, int, int>> points;
  for (const PatternImage& image : images)
    points.insert({image.point.surface, image.point.column, image.point.row});
  Report report;
  report.add("points in the pattern", std::to_string(scene.surfaces->pattern_points().size()),
             "points", scene.surfaces->pattern_points().size());
  report.add("of these, on the sensor", std::to_string(points.size()), "points_seen",
             points.size());
  report.add("images through microlenses", std::to_string(images.size()), "images", images.size());
  print(report, settings.json);
  return kSuccess;
}

}  // namespace

void register_corners(const Registry& registry) {
  auto settings = std::make_shared<CornersArguments>();
  CLI::App& command = add_command(
      registry, "corners",
      "Where the corners and dots of calibration patterns are, in the world and in the raw image",
      "plenoflame corners examples/calibration-plate.toml -o corners.csv");
  command.add_option("SCENE", settings->scene, "Scene file (.toml)")->required();
  add_set_option(command, settings->set);
  add_camera_option(command, settings->camera);
  add_option(command, "-o,--output", settings->output, "FILE",
             "File to write (.csv): a line for each point and microlens that shows it")
      ->check(written({".csv"}))
      ->required();
  add_option(command, "--rays", settings->rays, "N",
             "Rays over the aperture, for each point (default: 4096)");
  command.add_flag("--json", settings->json, "Print the figures as JSON");
  on_chosen(command, registry,
            [settings](const std::stop_token& stop) { return run_corners(*settings, stop); });
}

}  // namespace plenoflame::cli
