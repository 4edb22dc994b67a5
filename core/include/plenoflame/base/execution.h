#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <stop_token>
#include <string>

namespace plenoflame {

/// The state that a long computation reports while it runs.
struct Progress {
  double fraction = 0;         ///< of the work, 0 to 1
  double rays = 0;             ///< sent so far
  double rays_per_second = 0;  ///< over the whole run so far
  double relative_error = -1;  ///< estimated relative RMSE over lit pixels; negative: not known yet
  double remaining_seconds = -1;  ///< negative: not known yet
};

enum class Severity { note, warning };

/// Everything that a computation gets from its surroundings. Passed in, never global.
struct Execution {
  int threads = 0;  ///< worker threads; 0 takes one per processor
  std::stop_token stop;
  std::function<void(const Progress&)> progress;              ///< called from one thread at a time
  std::function<void(Severity, const std::string&)> message;  ///< warnings and notes, one line each

  void note(const std::string& text) const {
    if (message) message(Severity::note, text);
  }
  void warn(const std::string& text) const {
    if (message) message(Severity::warning, text);
  }
  /// The same number of threads, without stop and reports. For work that is also needed after a
  /// stop, such as writing the picture rendered so far.
  Execution threads_only() const {
    Execution inner;
    inner.threads = threads;
    return inner;
  }
  /// Number of worker threads that will be used, at least 1.
  int thread_count() const;
};

/// Calls task(index, worker) for every index below `count`, each exactly once, from
/// execution.thread_count() threads; `worker` tells which (0 based). Indices are handed out in
/// ascending order, so a task must not depend on who runs it. Ends early when execution.stop is
/// requested. The first exception of a task is rethrown after all threads have ended.
/// @return false when it was stopped early.
bool parallel_for(const Execution& execution, std::size_t count,
                  const std::function<void(std::size_t index, int worker)>& task);

}  // namespace plenoflame
