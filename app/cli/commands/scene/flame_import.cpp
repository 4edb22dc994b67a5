#include "commands/scene/flame_import.h"
#include "commands/add_option.h"
#include "commands/setting_options.h"

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "messages.h"
#include "number_range.h"
#include "outputs.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/report.h"
#include "plenoflame/math/readable.h"
#include "plenoflame/volumes/grid_file.h"
#include "progress_bar.h"
#include "run.h"
#include "terminal.h"
#include "vtk_commands.h"

namespace plenoflame::cli {
namespace {

struct FlameImportArguments {
  FlameImportRequest request;
  bool json = false;
};

int run_import(const FlameImportArguments& settings, const std::stop_token& stop) {
  const FlameImportRequest& request = settings.request;
  if (static_cast<int>(!request.absorption.empty()) + static_cast<int>(!request.soot.empty()) +
          static_cast<int>(request.constant > 0) !=
      1)
    throw UsageError(
        "the absorption is missing; give one of --absorption ARRAY, --soot ARRAY, --constant "
        "VALUE");
  Report report;
  nlohmann::json files = nlohmann::json::array();
  ProgressBar bar(false);
  Execution execution;
  execution.stop = stop;
  bar.connect(execution);
  std::vector<ImportedFlame> imported;
  try {
    imported = import_flames(request, execution);
  } catch (const Cancelled&) {
    bar.finish();
    say("stopped; the files of a series that were written are complete, and no others remain");
    return kFailure;
  }
  bar.finish();
  for (const ImportedFlame& flame : imported) {
    nlohmann::json entry{{"file", flame.file}, {"time_s", flame.time}};
    std::string text;
    for (const GridInfo& grid : list_grids(flame.file)) {  // what is in the file
      text += (text.empty() ? "" : "; ") + grid.name + " " + readable_number(grid.minimum) +
              " to " + readable_number(grid.maximum) + " " + grid.unit;
      entry["grids"].push_back({{"name", grid.name},
                                {"unit", grid.unit},
                                {"minimum", grid.minimum},
                                {"maximum", grid.maximum},
                                {"voxels", grid.active_voxels},
                                {"voxel_size_m", grid.voxel_size}});
    }
    report.add_text(flame.file, text);
    files.push_back(entry);
  }
  report.add_json("files", files);
  print(report, settings.json);
  return kSuccess;
}

}  // namespace

StoppableAction add_flame_import(CLI::App& flame) {
  const auto settings = std::make_shared<FlameImportArguments>();
  FlameImportRequest& request = settings->request;
  CLI::App& command = *flame.add_subcommand(
      "import",
      "Make a flame from a simulation's file: sample its mesh on voxels (in builds with VTK)");
  command.footer(
      "Example:\n  plenoflame flame import case.foam --soot fv --temperature T --voxel-size \"0.5 "
      "mm\" "
      "-o flame.vdb");
  command
      .add_option(
          "FILE", request.files,
          "VTK (.vtu .vti .vts .vtr .vtm .vtk ..., series .pvd), OpenFOAM (.foam), EnSight "
          "(.case), PLOT3D "
          "(.xyz with --solution, .p3d), CGNS, Exodus, Tecplot, NetCDF, the folder of an AMReX "
          "plotfile, or raw bricks (.json). Several files are a series")
      ->required();
  add_option(command, "-o,--output", request.output, "FILE",
             "The .vdb file to write; of a series NAME_0000.vdb, NAME_0001.vdb, ...")
      ->check(written({".vdb"}))
      ->required();
  add_settings<FlameImportRequest>(command, request);
  add_option(command, "--step", request.step, "N", "Only this time step, from 0; without it, all")
      ->check(number_from(0));
  command.add_flag("--half", request.half, "Store values with 16 bits");
  command.add_flag("--json", settings->json, "Print what was written as JSON");
  return [settings](const std::stop_token& stop) { return run_import(*settings, stop); };
}

}  // namespace plenoflame::cli
