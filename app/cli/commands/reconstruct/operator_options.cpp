#include "commands/reconstruct/operator_options.h"

#include <CLI/CLI.hpp>

#include "commands/part_option.h"
#include "commands/reconstruct/setting_options.h"
#include "commands/reconstruct/settings_file.h"
#include "commands/scene_input.h"
#include "outputs.h"

namespace plenoflame::cli {

void add_operator_options(CLI::App& command, OperatorArguments& arguments) {
  arguments.unknowns.names = kOptionNames;
  command
      .add_option_function<std::string>(
          "SCENE",
          [&command, &arguments](const std::string& file) {
            arguments.scene = scenes_or_settings(command, "SCENE", {file}, "operator").front();
          },
          "Scene file (.toml), or a file with a table [operator]")
      ->required();
  add_set_option(command, arguments.set);
  add_cameras_option(command, arguments.cameras);
  command
      .add_option("-o,--output", arguments.output,
                  "Sparse rows: .npz (scipy.sparse.load_npz), .h5, or .mtx (MatrixMarket)")
      ->check(written())
      ->required()
      ->option_text("FILE");
  command
      .add_option("--pixels", arguments.pixels,
                  "Pixel of each row (the first of its block or cell)")
      ->check(written())
      ->option_text("FILE.csv");
  command.add_option("--places", arguments.places, "Place and volume of each unknown [m, m^3]")
      ->check(written())
      ->option_text("FILE.csv");
  add_settings<UnknownsRequest>(command, arguments.unknowns);
  add_settings<OperatorRequest>(command, arguments);
  add_part_option(
      command, arguments.part,
      "Make only the rows of the Kth of N parts, which merge puts together (.npz, .h5)");
  command.add_option("--threads", arguments.threads, "Worker threads; 0: one per processor (0)")
      ->check(CLI::Range(0, 1024))
      ->option_text("N");
  command.add_flag("--quiet", arguments.quiet, "No progress on the terminal");
  command.add_flag("--json", arguments.json, "Print the figures as JSON");
}

}  // namespace plenoflame::cli
