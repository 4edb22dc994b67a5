#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "operator_problem.h"

namespace CLI {
class App;
}

namespace plenoflame::cli {

/// --compiled of commands that take rays from cameras that were compiled, one for each camera. Has
/// to be added after --rays and --seed, which mean nothing beside it.
void add_bundles_option(CLI::App& command, std::vector<std::string>& names);

/// Maps them into memory. @param cameras that there are @throws UsageError, FileError, InputError
NamedBundles read_bundles(const std::vector<std::string>& names, std::size_t cameras);

}  // namespace plenoflame::cli
