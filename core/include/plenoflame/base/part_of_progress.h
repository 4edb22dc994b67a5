#pragma once
#include "plenoflame/base/execution.h"

namespace plenoflame {

/// Reports what share of the work is done.
inline void report_fraction(const Execution& execution, double fraction) {
  if (!execution.progress) return;
  Progress progress;
  progress.fraction = fraction;
  execution.progress(progress);
}

/// The same threads and stop, for a step without visible progress and messages.
inline Execution without_reports(const Execution& execution) {
  Execution quiet = execution.threads_only();
  quiet.stop = execution.stop;
  return quiet;
}

/// The same with progress within a part of the whole. @param execution must outlive it
inline Execution part_of_progress(const Execution& execution, double from, double share) {
  Execution part = execution;
  if (execution.progress)
    part.progress = [&execution, from, share](Progress progress) {
      progress.fraction = from + share * progress.fraction;
      execution.progress(progress);
    };
  return part;
}

}  // namespace plenoflame
