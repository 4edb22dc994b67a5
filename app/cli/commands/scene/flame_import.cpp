#include "commands/scene/flame_import.h"
#include "commands/add_option.h"

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "choice.h"
#include "messages.h"
#include "number_range.h"
#include "options.h"
#include "outputs.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/report.h"
#include "plenoflame/volumes/flame_library.h"
#include "plenoflame/volumes/grid_file.h"
#include "progress_bar.h"
#include "run.h"
#include "terminal.h"
#include "vtk_commands.h"

namespace plenoflame::cli {
namespace {

struct FlameImportArguments {
  FlameImportRequest request;
  std::string voxel_size, wavelength, constant, bounds;
  bool json = false;
};

/// Six lengths: x low, x high, y low, ... @throws UsageError
std::array<double, 6> bounds_option(const std::string& text) {
  std::array<double, 6> bounds{};
  std::size_t begin = 0;
  for (std::size_t k = 0; k < 6; ++k) {
    const std::size_t comma = text.find(',', begin);
    if ((comma == std::string::npos) != (k == 5))
      throw UsageError(
          "--bounds: six lengths are needed: x low, x high, y low, y high, z low, z high");
    bounds[k] = quantity_option("--bounds", text.substr(begin, comma - begin), Dimension::length);
    begin = comma + 1;
  }
  for (std::size_t k = 0; k < 6; k += 2)
    if (!(bounds[k] < bounds[k + 1]))
      throw UsageError("--bounds: each low bound must be below its high one");
  return bounds;
}

int run_import(const FlameImportArguments& settings, const std::stop_token& stop) {
  FlameImportRequest request = settings.request;
  const auto positive = [](const char* option, double value) {
    if (!(value > 0)) throw UsageError(std::string(option) + ": must be above 0");
    return value;
  };
  if (!settings.voxel_size.empty())
    request.voxel_size = positive(
        "--voxel-size", quantity_option("--voxel-size", settings.voxel_size, Dimension::length));
  if (!settings.wavelength.empty())
    request.wavelength = positive(
        "--wavelength", quantity_option("--wavelength", settings.wavelength, Dimension::length));
  if (!settings.constant.empty())
    request.constant = positive(
        "--constant", quantity_option("--constant", settings.constant, Dimension::absorption));
  if (!settings.bounds.empty()) request.bounds = bounds_option(settings.bounds);
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
  add_option(command, "--solution", request.solution, "FILE",
             "PLOT3D: the solution (.q) of the grid");
  add_option(command, "--temperature", request.temperature, "ARRAY",
             "Array of the temperature (T)");
  add_option(command, "--temperature-unit", request.temperature_unit, "UNIT", "K or degC (K)")
      ->check(one_of({"K", "degC"}));
  add_option(command, "--temperature-scale", request.temperature_scale, "F",
             "Factor on the stored temperatures (1)")
      ->check(number_above(0));
  add_option(command, "--absorption", request.absorption, "ARRAY",
             "Array of the absorption coefficient");
  add_option(command, "--absorption-unit", request.absorption_unit, "UNIT",
             "1/m, 1/cm or 1/mm (1/m)")
      ->check(one_of({"1/m", "1/cm", "1/mm"}));
  add_option(command, "--soot", request.soot, "ARRAY", "Array of the volume fraction of soot");
  add_option(command, "--soot-function", request.soot_function, "E",
             "E(m) of soot, 0.2 to 0.4 (0.26)")
      ->check(number_between(1e-6, kGreatestSootFunction));
  add_option(command, "--wavelength", settings->wavelength, "LENGTH",
             "Wavelength at which the absorption holds (650 nm)");
  add_option(command, "--constant", settings->constant, "ABSORPTION",
             "Uniform absorption in the mesh, e.g. \"20 1/m\"");
  add_option(command, "--voxel-size", settings->voxel_size, "LENGTH",
             "Edge of a voxel (a 128th of the longest side)");
  add_option(command, "--bounds", settings->bounds, "BOX",
             "Part to import: x low, x high, y low, y high, z low, z high, with units");
  add_option(command, "--length-scale", request.length_scale, "F",
             "Metres per unit of the mesh (1)")
      ->check(number_above(0));
  add_option(command, "--step", request.step, "N", "Only this time step, from 0; without it, all")
      ->check(number_from(0));
  command.add_flag("--half", request.half, "Store values with 16 bits");
  command.add_flag("--json", settings->json, "Print what was written as JSON");
  return [settings](const std::stop_token& stop) { return run_import(*settings, stop); };
}

}  // namespace plenoflame::cli
