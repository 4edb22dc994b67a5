#include "sweep_request.h"

#include "plenoflame/base/error.h"
#include "plenoflame/image/text_file.h"

namespace plenoflame {

template <>
std::span<const SettingRow<SweepRequest>> setting_rows() {
  using R = SweepRequest;
  using enum SettingKind;
  static const std::vector<SettingRow<R>> rows{
      {"table", "FILE",
       "Table of the runs (.csv): keys of the scene in the header, one run per row", &R::table,
       file},
      {"random", "FILE", "Rules for random values (.toml): [[random]] tables", &R::random, file},
      {"runs", "N", "Number of runs to draw", &R::runs, between(1, kMostRuns)},
      {"test-share", "SHARE", "Share of the runs for testing, e.g. 20%",
       SettingText<R>{[](const R& r) { return setting_text(r.test_share); },
                      [](R& r, const SettingReader& value) {
                        r.test_share = value.quantity(Dimension::none);
                        if (!(r.test_share >= 0 && r.test_share < 1))
                          throw UsageError(value.setting() +
                                           " must be a share from 0 % to below 100 %, e.g. 20%, "
                                           "not '" +
                                           value.text() + "'");
                      }}},
      {"seed", "N", "Seed of the sweep", &R::seed}};
  return rows;
}

SweepRuns runs_of(const SweepRequest& request) {
  const SettingNames& names = request.names;
  if (request.table.empty() == request.random.empty())
    throw UsageError("the runs are missing; give " + names("table", "RUNS.csv") + " or " +
                     names("random", "RULES.toml"));
  SweepRuns found;
  if (!request.table.empty()) {
    if (request.runs)
      throw UsageError(names("runs") + " cannot be used with " + names("table") +
                       ", which has one run per row");
    found.values = read_sweep_table(read_text_file(request.table), request.table);
  } else {
    const SweepRules rules(read_text_file(request.random), request.random);
    const std::optional<int> count = request.runs ? request.runs : rules.runs();
    if (!count)
      throw UsageError("the number of runs is missing; give " + names("runs", "N") +
                       ", or runs = N in " + request.random);
    for (int run = 0; run < *count; ++run) found.values.push_back(rules.draw(*request.seed, run));
  }
  found.test =
      choose_test_runs(*request.seed, static_cast<int>(found.values.size()), request.test_share);
  return found;
}

}  // namespace plenoflame
