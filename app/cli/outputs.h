#pragma once

namespace CLI {
class App;
class Validator;
}  // namespace CLI

namespace plenoflame::cli {

/// Of an option that names what the command writes, a file or a folder; it refuses nothing itself:
///     command.add_option("-o,--output", settings->output, "What it is")->check(written());
CLI::Validator written();

/// Of an option whose file may be the one that is written: the command goes on with it.
CLI::Validator continued();

/// No output of a command may be another one, nor a file that it reads, by whatever name (links,
/// "./"). What it reads are all files that its other options and its scenes name.
/// @param app after parsing: the chosen command is looked at @throws UsageError
void check_outputs(CLI::App& app);

}  // namespace plenoflame::cli
