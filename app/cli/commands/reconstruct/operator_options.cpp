#include "commands/reconstruct/operator_options.h"
#include "commands/add_option.h"

#include <CLI/CLI.hpp>

#include "commands/part_option.h"
#include "commands/scene_input.h"
#include "commands/setting_options.h"
#include "commands/settings_file.h"
#include "outputs.h"

namespace plenoflame::cli {

void add_operator_options(CLI::App& command, OperatorArguments& arguments,
                          std::vector<FileOption>& file) {
  arguments.unknowns.names = kOptionNames;
  add_inputs(command, file, "SCENE", arguments.scene, "Scene file (.toml)",
             &arguments.unknowns.names);
  add_set_option(command, arguments.set);
  add_cameras_option(command, arguments.cameras);
  add_option(command, "-o,--output", arguments.output, "FILE",
             "Sparse rows: .npz (scipy.sparse.load_npz), .h5, or .mtx (MatrixMarket)")
      ->check(written({".npz", ".h5", ".mtx"}))
      ->required();
  add_option(command, "--pixels", arguments.pixels, "FILE.csv",
             "Pixel of each row (the first of its block or cell)")
      ->check(written());
  add_option(command, "--places", arguments.places, "FILE.csv",
             "Place and volume of each unknown [m, m^3]")
      ->check(written());
  add_settings<UnknownsRequest>(command, arguments.unknowns);
  add_settings<OperatorRequest>(command, arguments);
  add_part_option(
      command, arguments.part,
      "Make only the rows of the Kth of N parts, which merge puts together (.npz, .h5)");
  add_threads_option(command, arguments.threads);
  command.add_flag("--quiet", arguments.quiet, "No progress on the terminal");
  command.add_flag("--json", arguments.json, "Print the figures as JSON");
}

}  // namespace plenoflame::cli
