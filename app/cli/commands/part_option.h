#pragma once
#include <string>

#include "plenoflame/base/part.h"

namespace CLI {
class App;
}

namespace plenoflame::cli {

/// Adds --part. @param what is done with it
void add_part_option(CLI::App& command, std::string& part, const std::string& what);

/// Reads K/N, "auto/N" or "auto". With "auto/N", K is the number of the task in a Slurm job array,
/// counted from 1. With "auto", N is the number of the array's tasks.
/// @throws UsageError
Part part_option(const std::string& option, const std::string& text);

/// "part-2-of-4", which goes into the names of files.
std::string part_ending(const Part& part);

}  // namespace plenoflame::cli
