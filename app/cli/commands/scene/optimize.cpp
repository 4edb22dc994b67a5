#include <CLI/CLI.hpp>
#include <memory>

#include "camera_optimizer.h"
#include "commands/add_option.h"
#include "commands/commands.h"
#include "commands/scene_input.h"
#include "commands/setting_options.h"
#include "messages.h"
#include "outputs.h"
#include "plenoflame/scene/cameras.h"
#include "plenoflame/scene/scene_file.h"
#include "run.h"
#include "terminal.h"

namespace plenoflame::cli {
namespace {

struct OptimizeArguments {
  std::string scene, camera, output;
  std::vector<std::string> set;
  OptimizeRequest request;
  bool json = false;
};

int run_optimize(const OptimizeArguments& settings, const std::stop_token& stop) {
  std::vector<std::string> warnings;
  const Scene whole = read_valid_scene(settings.scene, settings.set, &warnings).scene;
  BetterCamera found = optimize_camera(
      settings.request, choose_camera({whole, {}}, settings.camera).scene.camera, stop);
  for (const std::string& warning : warnings) warn(warning);
  write_scene_file(settings.output, replace_camera(whole, found.camera));
  found.report.add("scene", settings.output, "scene", settings.output);
  print(found.report, settings.json);
  return kSuccess;
}

}  // namespace

void register_optimize(const Registry& registry) {
  auto settings = std::make_shared<OptimizeArguments>();
  CLI::App& command = add_command(registry, "optimize",
                                  "Find a better camera: microlenses, spacing, aperture, focus",
                                  "plenoflame optimize camera.toml --merit depth "
                                  "--array-range \"0.4 mm,-20 mm\" -o best.toml");
  command.add_option("SCENE", settings->scene, "Scene file (.toml) with the camera to start from")
      ->required();
  add_set_option(command, settings->set);
  add_camera_option(command, settings->camera);
  add_settings<OptimizeRequest>(command, settings->request);
  add_option(command, "-o,--output", settings->output, "SCENE.toml", "The optimised scene (.toml)")
      ->check(written())
      ->required();
  command.add_flag("--json", settings->json, "Print the figures as JSON");
  on_chosen(command, registry,
            [settings](const std::stop_token& stop) { return run_optimize(*settings, stop); });
}

}  // namespace plenoflame::cli
