#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "plenoflame/scene/sweep.h"
#include "settings.h"

namespace plenoflame {

/// A table or rules that give the runs of a sweep their values.
struct SweepRequest {
  SettingNames names = kOptionNames;
  std::string table = {}, random = {};  ///< files
  std::optional<int> runs = {};
  double test_share = 0;
  std::optional<std::uint64_t> seed = 1;
};

template <>
std::span<const SettingRow<SweepRequest>> setting_rows();

struct SweepRuns {
  std::vector<SweepRun> values;
  std::vector<bool> test;  ///< for each run: it is for testing
};

/// @throws UsageError where table, rules or number are missing; InputError with the place in the
/// file; FileError
SweepRuns runs_of(const SweepRequest& request);

}  // namespace plenoflame
