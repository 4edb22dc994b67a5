#pragma once
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace plenoflame::cli {

/// The files that a command names as scenes. If it names one file with a table of the command's
/// settings, these become its options, and the scenes are those of the table. Options of the
/// command line win. Call it while the argument is evaluated.
/// @param argument the positional one, "SCENES", whose key is "scenes" @param table
/// "reconstruction"
/// @throws InputError with line and column; FileError; UsageError for such a file beside others
std::vector<std::string> scenes_or_settings(CLI::App& command, const std::string& argument,
                                            const std::vector<std::string>& files,
                                            const std::string& table);

}  // namespace plenoflame::cli
