#pragma once
#include <mutex>

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

/// parallel_for() that reports the share of the finished tasks.
inline bool reported_parallel_for(const Execution& execution, std::size_t count,
                                  const std::function<void(std::size_t, int)>& task) {
  std::mutex mutex;
  std::size_t finished = 0;
  return parallel_for(execution, count, [&](std::size_t index, int worker) {
    task(index, worker);
    const std::lock_guard lock(mutex);
    report_fraction(execution, static_cast<double>(++finished) / static_cast<double>(count));
  });
}

}  // namespace plenoflame
