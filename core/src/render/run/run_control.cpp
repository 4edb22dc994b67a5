#include "render/run/run_control.h"

#include <algorithm>
#include <condition_variable>
#include <utility>

namespace plenoflame {

Deadline::Deadline(std::stop_token outer, double seconds)
    : forward_(std::move(outer), [this] { source_.request_stop(); }) {
  if (seconds <= 0) return;
  timer_ = std::jthread([this, seconds](const std::stop_token& ended) {
    std::unique_lock lock(mutex_);
    std::condition_variable_any wake;
    if (!wake.wait_for(lock, ended, std::chrono::duration<double>(seconds), [] { return false; }) &&
        !ended.stop_requested())
      source_.request_stop();
  });
}

bool Checkpoints::is_due() const {
  return seconds_since(last_) >= std::min(interval_, settings_.checkpoint_seconds);
}

void Checkpoints::was_kept() {
  interval_ *= 2;
  last_ = std::chrono::steady_clock::now();
}

void Checkpoints::offer(const Film& film) {
  if (!settings_.checkpoint || !is_due()) return;
  settings_.checkpoint(film);
  was_kept();
}

}  // namespace plenoflame
