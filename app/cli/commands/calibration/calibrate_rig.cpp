#include <CLI/CLI.hpp>
#include <memory>

#include "commands/add_option.h"
#include "commands/calibration/calibrate.h"
#include "commands/scene_input.h"
#include "commands/setting_options.h"
#include "messages.h"
#include "outputs.h"
#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/scene/scene_file.h"
#include "pose_calibration.h"
#include "run.h"
#include "terminal.h"

namespace plenoflame::cli {
namespace {

struct RigArguments {
  std::vector<std::string> cameras;
  RigRequest request;
  std::string output;
  bool json = false;
};

int run_rig(RigArguments& arguments) {
  for (const std::string& text : arguments.cameras) {
    const std::size_t sign = text.find('=');
    if (sign == std::string::npos || sign == 0 || sign + 1 == text.size())
      throw UsageError("'" + text +
                       "' is no CAMERA.toml=POSES.csv: the camera and the places of "
                       "its boards, both from calibrate geometry");
    const std::string file = text.substr(0, sign);
    arguments.request.cameras.push_back(
        {file, file, read_valid_scene(file).scene, read_poses(text.substr(sign + 1))});
  }
  check_writable(arguments.output);
  Execution execution;
  execution.message = [](Severity, const std::string& warning) { warn(warning); };
  FoundRig found = calibrate_rig(arguments.request, execution);
  write_scene_file(arguments.output, found.scene);
  found.report.add("scene", arguments.output, "output", arguments.output);
  print(found.report, arguments.json);
  return kSuccess;
}

}  // namespace

void add_calibrate_rig(CLI::App& calibrate, const Registry& registry) {
  auto a = std::make_shared<RigArguments>();
  CLI::App& command = *calibrate.add_subcommand(
      "rig", "Where several cameras stand, by boards that they have seen together");
  command.footer(
      "Example:\n"
      "  plenoflame calibrate rig left.toml=left-poses.csv right.toml=right-poses.csv -o rig.toml");
  command
      .add_option("CAMERA", a->cameras,
                  "CAMERA.toml=POSES.csv of calibrate geometry; a pose's number stands for one "
                  "place of the board, and the first camera stays")
      ->required();
  add_option(command, "-o,--output", a->output, "FILE.toml",
             "Scene file with all cameras, in the first one's world")
      ->check(written({".toml"}))
      ->required();
  add_settings<RigRequest>(command, a->request);
  command.add_flag("--json", a->json, "Print the figures as JSON");
  on_chosen(command, registry, [a] { return run_rig(*a); });
}

}  // namespace plenoflame::cli
