#include <CLI/CLI.hpp>
#include <algorithm>
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

#include "choice.h"
#include "commands/add_option.h"
#include "commands/command.h"
#include "commands/commands.h"
#include "commands/scene/flame_import.h"
#include "number_range.h"
#include "options.h"
#include "outputs.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/units.h"
#include "plenoflame/volumes/flame_file.h"
#include "plenoflame/volumes/flame_generators.h"
#include "plenoflame/volumes/grid_file.h"
#include "plenoflame/volumes/grid_writer.h"
#include "progress_bar.h"

namespace plenoflame::cli {
namespace {

struct FlameArguments {
  std::string name;
  std::string output;
  std::optional<std::string> voxel_size, wavelength, layers, seed, soot_function;
  std::vector<std::string> lines, parameters;
  bool half = false;
  std::string compression = "blosc";
  int threads = 0;
  bool json = false;
};

/// The flames of the table, a line each.
std::string list_of_flames() {
  std::string list;
  for (const FlameGenerator& generator : flame_generators()) {
    std::string name(generator.name);
    name.resize(11, ' ');
    list += "\n" + name + std::string(generator.what);
  }
  return list;
}

/// "candle, diffusion": the flames that have a parameter.
std::string flames_with(std::string_view parameter) {
  std::string names;
  for (const FlameGenerator& generator : flame_generators())
    for (const FlameParameter& p : generator.parameters())
      if (p.name == parameter) names.append(names.empty() ? "" : ", ").append(generator.name);
  return names;
}

/// Parameters of a flame for people to read.
std::string parameters_text(const FlameGenerator& generator) {
  std::string text;
  for (const FlameParameter& p : generator.parameters()) {
    std::string name = p.name + (p.value.empty() ? "" : " = " + p.value);
    name.resize(std::max<std::size_t>(name.size() + 2, 36), ' ');
    text += "  " + name + p.about + "\n";
  }
  return text;
}

/// The options that have a name of their own, and those of --set, as values of the table.
FlameValues values_of(const FlameArguments& s, const FlameGenerator& generator) {
  FlameValues values;
  const std::vector<FlameParameter> parameters = generator.parameters();
  const auto add = [&](const std::string& option, const std::string& name, std::string text) {
    const bool has = std::any_of(parameters.begin(), parameters.end(),
                                 [&](const FlameParameter& p) { return p.name == name; });
    if (!has && option != "--set")
      throw UsageError(option + " does not apply to the flame " + s.name);
    try {
      check_flame_value(generator, name, text);
    } catch (const InputError& error) {
      throw UsageError(option + ": " + (has && option == "--set" ? name + ": " : "") +
                       error.what());
    }
    if (!values.emplace(name, std::move(text)).second)
      throw UsageError(option + ": " + name + " is given twice");
  };
  if (s.layers) add("--layers", "layers", *s.layers);
  if (s.wavelength) add("--wavelength", "wavelength", *s.wavelength);
  if (s.soot_function) add("--soot-function", "soot_function", *s.soot_function);
  std::string lines;
  for (const std::string& line : s.lines) lines += (lines.empty() ? "" : ",") + line;
  if (!lines.empty()) add("--line", "lines", lines);
  if (s.seed) add("--seed", "seed", *s.seed);
  if (s.voxel_size) add("--voxel-size", "voxel_size", *s.voxel_size);
  for (const std::string& text : s.parameters) {
    const auto equals = text.find('=');
    if (equals == std::string::npos)
      throw UsageError("--set: '" + text +
                       "' is not of the form NAME=VALUE (--set help lists the parameters)");
    add("--set", text.substr(0, equals), text.substr(equals + 1));
  }
  return values;
}

void print(const FlameArguments& s, std::uint64_t size, const std::vector<GridInfo>& grids) {
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

int run(FlameArguments& s, const std::stop_token& stop) {
  if (s.name.empty()) throw UsageError("NAME is required (see plenoflame flame --help)");
  const FlameGenerator& generator = flame_generator(s.name);
  if (std::find(s.parameters.begin(), s.parameters.end(), "help") != s.parameters.end()) {
    std::cout << "Parameters of the flame " << s.name << ":\n" << parameters_text(generator);
    return 0;
  }
  if (s.output.empty()) throw UsageError("--output is required (see plenoflame flame --help)");
  const FlameValues values = values_of(s, generator);
  Execution execution;
  execution.threads = s.threads;
  execution.stop = stop;
  ProgressBar bar(false);
  bar.connect(execution);
  const FlameFields flame = generator.make(values, execution);
  GridWriteOptions options;
  options.half = s.half;
  options.compression = std::map<std::string, VdbCompression>{{"none", VdbCompression::none},
                                                              {"zip", VdbCompression::zip},
                                                              {"blosc", VdbCompression::blosc}}
                            .at(s.compression);
  options.metadata = flame_metadata(s.name, values);
  options.stop = execution.stop;
  const std::uint64_t size = write_flame(s.output, flame, options);
  bar.finish();
  print(s, size, list_grids(s.output));  // of what is in the file
  return 0;
}

}  // namespace

void register_flame(const Registry& registry) {
  const auto s = std::make_shared<FlameArguments>();
  CLI::App& command =
      add_command(registry, "flame",
                  "Write a flame to a .vdb file: grids of temperature [K] and absorption [1/m]",
                  "plenoflame flame candle -o candle.vdb\n"
                  "plenoflame flame layered --voxel-size \"0.5 mm\" --half -o layered.vdb");
  std::vector<std::string> names;
  for (const FlameGenerator& generator : flame_generators()) names.emplace_back(generator.name);
  command.add_option("NAME", s->name, "Kind of flame:" + list_of_flames())->check(one_of(names));
  add_option(command, "-o,--output", s->output, "FILE", "The .vdb file to write")
      ->check(written({".vdb"}));
  add_option(command, "--voxel-size", s->voxel_size, "LENGTH",
             "Edge of a voxel, such as \"0.25 mm\"");
  command.add_flag("--half", s->half, "Store values with 16 bits: relative error 2^-11");
  add_option(command, "--compression", s->compression, "NAME",
             "Compression of the file: none, zip or blosc")
      ->check(one_of({"none", "zip", "blosc"}))
      ->capture_default_str();
  add_option(command, "--layers", s->layers, "FILE",
             flames_with("layers") + ": TOML file with [[layers]] tables");
  add_option(command, "--wavelength", s->wavelength, "LENGTH",
             flames_with("wavelength") + ": wavelength at which the absorption holds (650 nm)");
  add_option(
      command, "--soot-function", s->soot_function, "E",
      flames_with("soot_function") + ": absorption function E(m) of soot, 0.2 to 0.4 (0.26)");
  add_option(command, "--line", s->lines, "LINE",
             flames_with("lines") +
                 ": add a grid of an emission line: ch, c2_517, oh, na_d, or with its peak "
                 "\"ch=200 W/m^3\" (100 W/m^3); repeatable")
      ->take_all()
      ->allow_extra_args(false);
  add_option(command, "--seed", s->seed, "N", flames_with("seed") + ": seed of the plume (1)");
  add_option(
      command, "--set", s->parameters, "NAME=VALUE",
      "A parameter of the flame, e.g. --set \"height=40 mm\"; repeatable; --set help lists them")
      ->take_all()
      ->allow_extra_args(false);
  add_option(command, "--threads", s->threads, "N", "Worker threads; 0: one per processor (0)")
      ->check(number_from(0));
  command.add_flag("--json", s->json, "Print what was written as JSON");
#ifdef PLENOFLAME_HAS_VTK
  const StoppableAction import_action = add_flame_import(command);
  const CLI::App* const import_command = command.get_subcommand("import");
  on_chosen(command, registry, [s, import_action, import_command](const std::stop_token& stop) {
    return import_command->parsed() ? import_action(stop) : run(*s, stop);
  });
#else
  add_missing(command, "import", "VTK", "Make a flame from a simulation's file");
  on_chosen(command, registry, [s](const std::stop_token& stop) { return run(*s, stop); });
#endif
}

}  // namespace plenoflame::cli
