#pragma once
#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace plenoflame::cli {

/// Accepts one of these words, and no others; the message names the one that is probably meant.
CLI::Validator one_of(std::vector<std::string> words);

}  // namespace plenoflame::cli
