#pragma once
#include <chrono>
#include <functional>
#include <mutex>
#include <stop_token>
#include <thread>

#include "plenoflame/film/film.h"
#include "plenoflame/render/render.h"

namespace plenoflame {

/// Seconds since a moment.
inline double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Points per replicate; all replicates have the same number.
inline int samples_per_replicate(const RenderSettings& settings) {
  return (settings.samples + settings.replicates - 1) / settings.replicates;
}

/// Requests a stop when the time is over, or when the caller's own token does.
class Deadline {
 public:
  /// @param seconds [s] from now; 0: no limit
  Deadline(std::stop_token outer, double seconds);
  std::stop_token token() const { return source_.get_token(); }

 private:
  std::stop_source source_;
  std::mutex mutex_;
  std::stop_callback<std::function<void()>> forward_;
  std::jthread timer_;
};

/// Calls settings.checkpoint when it is due: after kFirstCheckpoint, then at intervals that double
/// up to settings.checkpoint_seconds.
class Checkpoints {
 public:
  explicit Checkpoints(const RenderSettings& settings) : settings_(settings) {}
  void offer(const Film& film);
  bool is_due() const;
  void was_kept();  ///< the caller has just saved the state

 private:
  static constexpr double kFirstCheckpoint = 5;  ///< [s]
  const RenderSettings& settings_;
  double interval_ = kFirstCheckpoint;  ///< [s]
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace plenoflame
