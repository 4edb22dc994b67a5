#pragma once
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>
#include <vector>

namespace plenoflame::cli {

/// Numbers of runs that are still to be made, taken by several threads.
class RunQueue {
 public:
  /// Empty, and more will come: next() waits for it.
  RunQueue() = default;
  /// These, and no more will come.
  explicit RunQueue(const std::vector<int>& runs) : runs_(runs.begin(), runs.end()), open_(false) {}

  void add(int run) {
    const std::lock_guard lock(mutex_);
    runs_.push_back(run);
    changed_.notify_one();
  }
  /// Ends the queue. @param drop also removes waiting runs
  void close(bool drop) {
    const std::lock_guard lock(mutex_);
    open_ = false;
    if (drop) runs_.clear();
    changed_.notify_all();
  }
  /// @return nothing when there is no more
  std::optional<int> next() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return !open_ || !runs_.empty(); });
    if (runs_.empty()) return std::nullopt;
    const int run = runs_.front();
    runs_.pop_front();
    return run;
  }
  std::size_t left() const {
    const std::lock_guard lock(mutex_);
    return runs_.size();
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<int> runs_;
  bool open_ = true;
};

}  // namespace plenoflame::cli
