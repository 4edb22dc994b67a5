#include <CLI/CLI.hpp>
#include <cstdint>
#include <iomanip>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "commands/command.h"
#include "commands/commands.h"
#include "commands/flame_import.h"
#include "interrupt.h"
#include "number_range.h"
#include "options.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/units.h"
#include "plenoflame/base/version.h"
#include "plenoflame/radiometry/emission_line.h"
#include "plenoflame/scene/spectral.h"
#include "plenoflame/volumes/flame_file.h"
#include "plenoflame/volumes/flame_library.h"
#include "plenoflame/volumes/grid_file.h"
#include "plenoflame/volumes/grid_writer.h"
#include "progress_bar.h"

namespace plenoflame::cli {
namespace {

struct Settings {
  std::string name;
  std::string output;
  std::optional<std::string> voxel_size, wavelength, layers, seed_text;
  std::uint64_t seed = 1;
  std::optional<double> soot_function;
  std::vector<std::string> lines;
  bool half = false;
  std::string compression = "blosc";
  int threads = 0;
  bool json = false;
};

constexpr const char* kNames =
    "layered    three homogeneous ellipsoids, or those of --layers\n"
    "candle     a candle's flame, soot in an annulus\n"
    "diffusion  a laminar co-flow diffusion flame, soot in an annulus\n"
    "cylinder   a grey cylinder of 80 mm radius with a smooth temperature\n"
    "turbulent  a wrinkled plume with many scales, from a seed";

double length(const char* option, const std::string& text) {
  try {
    const double value = parse_quantity(text, Dimension::length);
    if (value > 0 && value < 1e3) return value;
  } catch (const InputError& error) {
    throw UsageError(std::string(option) + ": " + error.what());
  }
  throw UsageError(std::string(option) + ": \"" + text + "\" must be above 0 and below 1 km");
}

/// "ch" or "ch=200 W/m^3": a grid of an emission line.
SootFlameOptions::Line line_option(const std::string& text) {
  constexpr double kPeak = 100;  // [W/m^3]
  const auto equals = text.find('=');
  const std::string name = text.substr(0, equals);
  std::string known;
  for (const LineGrid& line : line_grids()) {
    const std::string_view word = line_word(line.kind);
    known.append(known.empty() ? "" : ", ").append(word);
    if (name != word) continue;
    const std::string grid(line.name);
    if (equals == std::string::npos) return {grid, kPeak};
    std::istringstream value(text.substr(equals + 1));
    double number = 0;
    std::string unit;
    if (value >> number && std::getline(value >> std::ws, unit)) {
      const auto factor = emission_unit(unit, EmissionLine::named(name).wavelength());
      if (factor && number > 0) return {grid, number * *factor};
    }
    throw UsageError("--line: \"" + text + "\" needs a peak above 0 with its unit, such as " +
                     name + "=\"200 W/m^3\"");
  }
  throw UsageError("--line: there is no line \"" + name + "\"; known are " + known);
}

/// Makes sure that no option is given that the flame has no use for.
void check_use(const Settings& s) {
  const bool layered = s.name == "layered", sooty = s.name == "candle" || s.name == "diffusion";
  const auto refuse = [&](bool given, const char* option) {
    if (given) throw UsageError(std::string(option) + " has no meaning for the flame " + s.name);
  };
  if (!layered) refuse(s.layers.has_value(), "--layers");
  if (!sooty) refuse(s.wavelength.has_value(), "--wavelength");
  if (!sooty) refuse(s.soot_function.has_value(), "--soot-function");
  if (!sooty) refuse(!s.lines.empty(), "--line");
  if (s.name != "turbulent") refuse(s.seed_text.has_value(), "--seed");
  if (!s.output.ends_with(".vdb"))
    throw UsageError("--output: '" + s.output + "' must end in .vdb");
  if (s.layers) check_not_overwritten("--output", s.output, *s.layers);
}

FlameFields generate(const Settings& s, const Execution& execution) {
  const auto set_voxel_size = [&](double& size) {
    if (s.voxel_size) size = length("--voxel-size", *s.voxel_size);
  };
  if (s.name == "layered") {
    LayeredFlameOptions options;
    if (s.layers) options.layers = read_layers(*s.layers);
    set_voxel_size(options.voxel_size);
    return make_layered_flame(options, execution);
  }
  if (s.name == "candle" || s.name == "diffusion") {
    SootFlameOptions options = s.name == "candle" ? candle_flame() : diffusion_flame();
    if (s.soot_function) options.absorption_function = *s.soot_function;
    if (s.wavelength) options.wavelength = length("--wavelength", *s.wavelength);
    for (const std::string& text : s.lines) {
      SootFlameOptions::Line line = line_option(text);
      for (const SootFlameOptions::Line& other : options.lines)
        if (other.name == line.name) throw UsageError("--line: " + text + " is given twice");
      options.lines.push_back(std::move(line));
    }
    set_voxel_size(options.voxel_size);
    return make_soot_flame(options, execution);
  }
  if (s.name == "cylinder") {
    CylinderFlameOptions options;
    set_voxel_size(options.voxel_size);
    return make_cylinder_flame(options, execution);
  }
  TurbulentFlameOptions options;
  options.seed = s.seed;
  set_voxel_size(options.voxel_size);
  return make_turbulent_flame(options, execution);
}

void print(const Settings& s, std::uint64_t size, const std::vector<GridInfo>& grids) {
  if (s.json) {
    nlohmann::ordered_json report{{"file", s.output}, {"flame", s.name}, {"size_bytes", size}};
    for (const GridInfo& grid : grids) {
      const Box& b = grid.world_bounds;
      report["grids"].push_back({{"name", grid.name},
                                 {"unit", grid.unit},
                                 {"minimum", grid.minimum},
                                 {"maximum", grid.maximum},
                                 {"background", grid.background},
                                 {"voxels", grid.active_voxels},
                                 {"voxel_size_m", grid.voxel_size},
                                 {"half", grid.half},
                                 {"lower_m", {b.lower.x, b.lower.y, b.lower.z}},
                                 {"upper_m", {b.upper.x, b.upper.y, b.upper.z}}});
    }
    std::cout << report.dump(2) << '\n';
    return;
  }
  std::cout << s.output << ": flame " << s.name << ", " << std::fixed << std::setprecision(2)
            << static_cast<double>(size) / 1e6 << " MB\n"
            << std::defaultfloat << std::setprecision(6);
  for (const GridInfo& grid : grids) {
    const Box& b = grid.world_bounds;
    const auto mm = [](Vec3 p) {
      std::ostringstream text;
      text << '(' << p.x * 1e3 << ", " << p.y * 1e3 << ", " << p.z * 1e3 << ")";
      return text.str();
    };
    std::cout << "  " << std::left << std::setw(12) << grid.name << grid.minimum << " to "
              << grid.maximum << ' ' << grid.unit << ", " << grid.active_voxels << " voxels of "
              << readable(grid.voxel_size, Dimension::length) << ", from " << mm(b.lower) << " to "
              << mm(b.upper) << " mm\n";
  }
}

int run(Settings& s) {
  if (s.name.empty()) throw UsageError("NAME is required (see plenoflame flame --help)");
  if (s.output.empty()) throw UsageError("--output is required (see plenoflame flame --help)");
  check_use(s);
  if (s.seed_text) s.seed = whole_number_option<std::uint64_t>("--seed", *s.seed_text, 0);
  if (s.soot_function && !(*s.soot_function > 0 && *s.soot_function <= kGreatestSootFunction))
    throw UsageError(
        "--soot-function: E(m) of soot is above 0 and at most 1 (published values: 0.2 to 0.4), "
        "not " +
        readable_number(*s.soot_function));
  const InterruptHandler interrupt;
  Execution execution;
  execution.threads = s.threads;
  execution.stop = interrupt.token();
  ProgressBar bar(false);
  bar.connect(execution);
  FlameFields flame = generate(s, execution);
  std::vector<GridOutput> grids{{&flame.temperature, "K"}, {&flame.absorption, "1/m"}};
  for (const VoxelField& line : flame.lines) grids.push_back({&line, "W/m^3"});
  GridWriteOptions options;
  options.half = s.half;
  options.compression = std::map<std::string, VdbCompression>{{"none", VdbCompression::none},
                                                              {"zip", VdbCompression::zip},
                                                              {"blosc", VdbCompression::blosc}}
                            .at(s.compression);
  options.metadata = {{"creator", "plenoflame " + std::string(version())}, {"flame", s.name}};
  options.stop = execution.stop;
  if (s.name == "turbulent") options.metadata["seed"] = std::to_string(s.seed);
  const std::uint64_t size = write_grids(s.output, grids, options);
  bar.finish();
  print(s, size, list_grids(s.output));  // of what is in the file
  return 0;
}

}  // namespace

void register_flame(const Registry& registry) {
  const auto s = std::make_shared<Settings>();
  CLI::App& command =
      add_command(registry, "flame",
                  "Write a flame to a .vdb file: grids of temperature [K] and absorption [1/m]",
                  "plenoflame flame candle -o candle.vdb\n"
                  "plenoflame flame layered --voxel-size \"0.5 mm\" --half -o layered.vdb");
  command.add_option("NAME", s->name, std::string("Which flame:\n") + kNames)
      ->check(CLI::IsMember({"layered", "candle", "diffusion", "cylinder", "turbulent"}));
  command.add_option("-o,--output", s->output, "The .vdb file to write");
  command.add_option("--voxel-size", s->voxel_size, "Edge of a voxel, such as \"0.25 mm\"");
  command.add_flag("--half", s->half,
                   "Store values with 16 bits: half the size, relative error 2^-11");
  command.add_option("--compression", s->compression, "none, zip or blosc")
      ->check(CLI::IsMember({"none", "zip", "blosc"}))
      ->capture_default_str();
  command.add_option("--layers", s->layers, "layered: TOML file with [[layers]] tables");
  command.add_option("--wavelength", s->wavelength,
                     "candle, diffusion: at which the absorption holds (650 nm)");
  command.add_option("--soot-function", s->soot_function,
                     "candle, diffusion: absorption function E(m) of soot, 0.2 to 0.4 (0.26)");
  command
      .add_option(
          "--line", s->lines,
          "candle, diffusion: a grid of an emission line as well, with its peak: ch, c2_517, "
          "oh, na_d, or \"ch=200 W/m^3\" (100 W/m^3); may be given several times")
      ->option_text("LINE")
      ->take_all()
      ->allow_extra_args(false);
  command.add_option("--seed", s->seed_text, "turbulent: which plume (1)")->option_text("N");
  command.add_option("--threads", s->threads, "Worker threads; 0: one per processor")
      ->check(number_from(0));
  command.add_flag("--json", s->json, "Print what was written as JSON");
#ifdef PLENOFLAME_HAS_VTK
  const Action import_action = add_flame_import(command);
  const CLI::App* const import_command = command.get_subcommand("import");
  on_chosen(command, registry, [s, import_action, import_command] {
    return import_command->parsed() ? import_action() : run(*s);
  });
#else
  on_chosen(command, registry, [s] { return run(*s); });
#endif
}

}  // namespace plenoflame::cli
