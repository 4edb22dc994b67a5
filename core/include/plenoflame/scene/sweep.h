#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "plenoflame/base/error.h"

/// Sweeps: many runs of one scene, each with values of its own for some of the scene's keys.
namespace plenoflame {

/// The value that a run gives to a key of the scene.
struct SweepValue {
  std::string key;          ///< path as in SceneSettings::values
  std::string value;        ///< as text, with its unit
  SourcePosition position;  ///< of the cell of the table, or of the rule
};
using SweepRun = std::vector<SweepValue>;

inline constexpr int kMostRuns = 10'000'000;

/// Reads runs from a table with commas, or semicolons or tabs, between its columns: a header of
/// keys, a run in each further line. Cells with commas stand in double quotes; an empty one leaves
/// the scene's value. "KEY [mm]" in the header gives the unit of all numbers below. Lines that
/// begin with # and empty ones are skipped.
/// @param name of the file, for messages @throws InputError with line and column
std::vector<SweepRun> read_sweep_table(std::string_view text, const std::string& name);

/// Distributions from which the values of a sweep are drawn. TOML: `runs` (their number, unless the
/// caller gives one), and a [[random]] table for each key. A table has `key` and one of:
/// - uniform = [LEAST, GREATEST]: any number between
/// - log_uniform = [LEAST, GREATEST]: its logarithm is uniform
/// - normal = [MEAN, DEVIATION]: with `limits = [LEAST, GREATEST]` drawn again outside
/// - integer = [LEAST, GREATEST]: integers, both ends included
/// - choice = [A, B, ...]: one of these
/// - value = A: this one, in all runs
///
/// Numbers with a unit are texts, "2 mm". For a key with several numbers the ends are arrays.
class SweepRules {
 public:
  /// @param name of the file, for messages @throws InputError with line and column
  SweepRules(std::string_view text, const std::string& name);

  /// Depends on seed, number and each rule alone: not on other runs, nor on other rules.
  SweepRun draw(std::uint64_t seed, int run) const;
  std::optional<int> runs() const { return runs_; }

 private:
  enum class Law { uniform, log_uniform, normal, integer, choice };
  struct Axis {
    double first = 0, second = 0;  ///< ends, or mean and deviation
    double least = 0, greatest = 0;
    std::string unit;
  };
  struct Rule {
    std::string key;
    SourcePosition position;
    Law law = Law::choice;
    bool limited = false;
    std::vector<Axis> axes;
    std::vector<std::string> choices;
  };
  struct Reader;

  std::vector<Rule> rules_;
  std::optional<int> runs_;
};

/// Seed of a run's picture, of 63 bits.
std::uint64_t seed_of_run(std::uint64_t sweep_seed, int run);

/// Tells for each run whether it is for testing: a random choice of round(share * runs) of them.
std::vector<bool> choose_test_runs(std::uint64_t sweep_seed, int runs, double share);

}  // namespace plenoflame
