#include <CLI/CLI.hpp>

#include "choice.h"
#include "commands/part_option.h"
#include "commands/scene_input.h"
#include "commands/series/sweep_plan.h"
#include "outputs.h"

namespace plenoflame::cli {

void add_sweep_options(CLI::App& command, SweepArguments& arguments) {
  RenderArguments& render = arguments.render;
  RenderOptions& options = render.options;
  command.add_option("SCENE", options.scene, "Scene file (.toml)")->required();
  command
      .add_option("--table", arguments.table,
                  "Table of the runs (.csv): keys of the scene in the header, one run per row")
      ->option_text("FILE");
  command
      .add_option("--random", arguments.random,
                  "Rules for random values (.toml): [[random]] tables")
      ->option_text("FILE");
  command.add_option("--runs", arguments.runs, "Number of runs to draw")->option_text("N");
  command
      .add_option("-o,--output", arguments.output,
                  "Folder of the data set; an unfinished one is continued")
      ->check(written())
      ->required()
      ->option_text("DIR");
  add_set_option(command, options.set);
  add_cameras_option(command, options.cameras);
  command
      .add_option("--format", arguments.format,
                  "exr: a light field for each picture; hdf5: one file set.h5 (exr)")
      ->check(one_of({"exr", "hdf5"}))
      ->option_text("NAME");
  command
      .add_option("--lattice", arguments.lattice,
                  "Save true temperature, absorption and emission lines on NX x NY x NZ cells")
      ->option_text("NX,NY,NZ");
  command
      .add_option("--region", arguments.region,
                  "Box of the lattice, two corners (around the scene's flames)")
      ->option_text("X,Y,Z:X,Y,Z");
  command
      .add_option("--test-share", arguments.test_share,
                  "Share of the runs for testing, e.g. 20% (0)")
      ->option_text("SHARE");
  command.add_option("--seed", arguments.seed, "Seed of the sweep (1)")->option_text("N");
  add_part_option(command, arguments.part,
                  "Make only part K of N, in DIR-part-K-of-N; 'plenoflame merge' joins them to "
                  "exactly the whole set");
  command.add_option("--samples", render.samples, "Rays per pixel and microlens")->option_text("N");
  command
      .add_option("--target-error", render.target_error,
                  "Render each picture until its relative RMSE is below this, e.g. 1%")
      ->option_text("SHARE");
  command.add_option("--window", render.window, "Only W x H pixels from column X, row Y")
      ->option_text("X,Y,W,H");
  command.add_flag("--truth", options.truth, "Add layers of ground truth, see render");
  command.add_option("--threads", options.threads, "Worker threads; 0: one per processor (0)")
      ->check(CLI::Range(0, 4096))
      ->option_text("N");
  command.add_flag("--quiet", options.quiet, "No progress and no notes; warnings remain");
  command.add_flag("--json", options.json, "Print the figures as JSON");
}

}  // namespace plenoflame::cli
