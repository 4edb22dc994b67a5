#include "commands/part_option.h"
#include "commands/add_option.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdlib>

#include "options.h"
#include "plenoflame/base/error.h"

namespace plenoflame::cli {
namespace {

/// A number that Slurm says of the task of a job array. @throws UsageError when it does not, or
/// wrongly
int of_array(const std::string& option, const char* name) {
  const char* const value = std::getenv(name);
  if (!value)
    throw UsageError(fmt::format(
        "{}: 'auto' is for the tasks of a Slurm job array, and {} is not set; give {} K/N", option,
        name, option));
  return whole_number_option(name, value, 0, kMostParts);
}

}  // namespace

void add_part_option(CLI::App& command, std::string& part, const std::string& what) {
  add_option(
      command, "--part", part, "K/N",
      what + "; 'auto/N' takes K from SLURM_ARRAY_TASK_ID, 'auto' also takes N from the job array");
}

Part part_option(const std::string& option, const std::string& text) {
  try {
    if (!text.starts_with("auto")) return part_from(text);
    const int task = of_array(option, "SLURM_ARRAY_TASK_ID");
    // The number of parts is given: a task that is restarted alone is in an array of one.
    if (text.starts_with("auto/")) return part_from(std::to_string(task) + text.substr(4));
    if (text != "auto") return part_from(text);
    const int first = of_array(option, "SLURM_ARRAY_TASK_MIN");
    const int count = of_array(option, "SLURM_ARRAY_TASK_COUNT");
    const int last = of_array(option, "SLURM_ARRAY_TASK_MAX");
    if (last - first + 1 != count)
      throw UsageError("the task numbers of the job array have gaps; give auto/N");
    return part_from(fmt::format("{}/{}", task - first + 1, count));
  } catch (const UsageError& error) {
    const std::string message = error.what();
    throw UsageError(message.starts_with(option) ? message : option + ": " + message);
  }
}

std::string part_ending(const Part& part) {
  return fmt::format("part-{}-of-{}", part.number, part.count);
}

}  // namespace plenoflame::cli
