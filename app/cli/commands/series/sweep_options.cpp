#include <CLI/CLI.hpp>

#include "choice.h"
#include "commands/add_option.h"
#include "commands/part_option.h"
#include "commands/scene_input.h"
#include "commands/series/sweep_plan.h"
#include "commands/setting_options.h"
#include "commands/settings_file.h"
#include "outputs.h"

namespace plenoflame::cli {

void add_sweep_options(CLI::App& command, SweepArguments& arguments,
                       std::vector<FileOption>& file) {
  RenderArguments& render = arguments.render;
  RenderOptions& options = render.options;
  add_inputs(command, file, "SCENE", options.scene, "Scene file (.toml)");
  add_settings<SweepRequest>(command, arguments.sweep);
  add_option(command, "-o,--output", arguments.output, "DIR",
             "Folder of the data set; an unfinished one is continued")
      ->check(written())
      ->required();
  add_set_option(command, options.set);
  add_cameras_option(command, options.cameras);
  add_option(command, "--format", arguments.format, "NAME",
             "exr: a light field for each picture; hdf5: one file set.h5 (exr)")
      ->check(one_of({"exr", "hdf5"}));
  add_option(command, "--lattice", arguments.lattice, "NX,NY,NZ",
             "Save true temperature, absorption and emission lines on NX x NY x NZ cells");
  add_option(command, "--region", arguments.region, "X,Y,Z:X,Y,Z",
             "Box of the lattice, two corners (around the scene's flames)");
  add_part_option(command, arguments.part,
                  "Make only part K of N, in DIR-part-K-of-N; 'plenoflame merge' joins them to "
                  "exactly the whole set");
  add_option(command, "--samples", render.samples, "N", "Rays per pixel and microlens");
  add_option(command, "--target-error", render.target_error, "SHARE",
             "Render each picture until its relative RMSE is below this, e.g. 1%");
  add_option(command, "--window", render.window, "X,Y,W,H",
             "Only W x H pixels from column X, row Y");
  command.add_flag("--truth", options.truth, "Add layers of ground truth, see render");
  add_threads_option(command, options.threads);
  command.add_flag("--quiet", options.quiet, "No progress and no notes; warnings remain");
  command.add_flag("--json", options.json, "Print the figures as JSON");
}

}  // namespace plenoflame::cli
