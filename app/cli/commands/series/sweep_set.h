#pragma once
#include <string>
#include <vector>

#include "commands/series/sweep_plan.h"

namespace plenoflame::cli {

/// True if a run's files are all there: its record is written with them.
bool run_is_done(const std::string& folder, int run);

/// Writes index.csv of a set that has all its runs. For HDF5 it also writes set.h5, which replaces
/// the runs' own files.
/// @param plan sweep.json
/// @param runs this part's runs, in order
/// @return runs with flames that reach beyond the lattice of the truth
/// @throws FileError, Cancelled; existing files stay
std::vector<int> finish_set(const std::string& folder, const nlohmann::ordered_json& plan,
                            const std::vector<int>& runs, bool pack, const std::stop_token& stop);

/// Reads sweep.json of a set. @throws FileError, InputError
nlohmann::ordered_json read_plan(const std::string& folder);

/// Names the first entry in which two plans differ; empty: none.
std::string plan_difference(const nlohmann::ordered_json& then, const nlohmann::ordered_json& now);

/// Says in one line that some runs' truth lacks a part of the flame; empty: none does.
std::string beyond_lattice_warning(const std::vector<int>& runs);

/// Puts parts of a sweep together into a folder that is not there yet, or empty.
/// @return as finish_set()
/// @throws InputError for parts that are missing, doubled, unfinished or of other sweeps
std::vector<int> merge_sets(const std::vector<std::string>& parts, const std::string& output,
                            const std::stop_token& stop);

}  // namespace plenoflame::cli
