#pragma once
#include <CLI/CLI.hpp>

namespace plenoflame::cli {

/// Accepts finite numbers in [low, high], and no others: a range of comparisons lets "nan" pass.
CLI::Validator number_between(double low, double high);
/// Accepts finite numbers above `low`.
CLI::Validator number_above(double low);
/// Accepts finite numbers from `low` on.
CLI::Validator number_from(double low);

}  // namespace plenoflame::cli
