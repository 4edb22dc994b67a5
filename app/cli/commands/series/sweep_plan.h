#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "commands/render/render_options.h"
#include "plenoflame/base/execution.h"
#include "plenoflame/base/part.h"
#include "plenoflame/math/vector.h"
#include "sweep_request.h"

namespace CLI {
class App;
}

namespace plenoflame::cli {

struct FileOption;

/// The command line of `sweep`.
struct SweepArguments {
  RenderArguments render;  ///< scene, --set, --camera, --samples, --window, --threads, ...
  SweepRequest sweep;
  std::string output, format = "exr", lattice, region, part;
};

/// Adds the options of `sweep` to its command.
void add_sweep_options(CLI::App& command, SweepArguments& arguments, std::vector<FileOption>& file);

/// A flame of a run that is made by a generator.
struct GeneratedFlame {
  std::string generator;
  std::map<std::string, std::string> values;
};

/// Settings of one run: values of the scene, and flames that are generated, by their number.
struct RunSettings {
  std::vector<std::string> set;  ///< as of --set, the sweep's own first
  std::map<int, GeneratedFlame> flames;
};

/// The lattice on which the truth is kept.
struct TruthLattice {
  std::array<int, 3> count{};
  Box box;
};

/// All that decides what a sweep's files are.
struct SweepPlan {
  SweepArguments arguments;
  RenderOptions options;  ///< of every run, before its own values
  std::vector<SweepRun> runs;
  std::vector<bool> test;
  Part part;
  std::optional<TruthLattice> lattice;
  std::string folder;           ///< with the part's ending
  nlohmann::ordered_json text;  ///< sweep.json: equal plans make equal files

  std::uint64_t seed() const { return *arguments.sweep.seed; }
  bool is_mine(int run) const { return run % part.count == part.number - 1; }
  bool packs() const { return arguments.format == "hdf5"; }
  RunSettings settings(int run) const;
  RenderOptions options_of(int run) const;
};

/// The state in which plan_sweep() finds the runs: rank 0 has checked those of the others.
enum class RunsAre { unchecked, checked };

/// Reads table or rules, and checks every run of the part: all errors come before any work.
/// @throws InputError with the place in the table or the rules; UsageError, FileError
SweepPlan plan_sweep(const SweepArguments& arguments, const Execution& execution,
                     RunsAre runs = RunsAre::unchecked);

/// Calls it with an error's text at the place of the value that it is about.
[[noreturn]] void throw_of_run(const SweepPlan& plan, int run, const std::string& message);

/// "000012": the start of the names of a run's files.
std::string run_name(int run);

}  // namespace plenoflame::cli
