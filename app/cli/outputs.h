#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace plenoflame::cli {

/// Marks an option that names an output, a file or a folder:
///     command.add_option("-o,--output", settings->output, "What it is")->check(written({".csv"}));
/// @param endings that a file may have; none: any
CLI::Validator written(std::vector<std::string> endings = {});

/// An option is marked as written().
bool is_output(CLI::Option& option);

/// Marks an option whose file may also be the output: the command continues it.
CLI::Validator continued();

/// No output of a command may be another output or one of its inputs, by whatever name (links,
/// "./"). Inputs are all files that its other options and its scenes name.
/// @param app after parsing: the chosen command is checked @throws UsageError
void check_outputs(CLI::App& app);

}  // namespace plenoflame::cli
