#pragma once
#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace plenoflame::cli {

/// Accepts one of these words, and no others; the message names the one that is probably meant.
CLI::Validator one_of(std::vector<std::string> words);

/// Accepts names of files with one of these endings. It is active for a file of settings; the
/// command looks at its own line after it has compared its files.
CLI::Validator ending_in(std::vector<std::string> endings);

}  // namespace plenoflame::cli
