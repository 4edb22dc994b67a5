// Measures the longest time in which the window's thread did not turn to events.
#pragma once
#include <QObject>
#include <QTimer>
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <string>

namespace plenoflame::desktop::test {

inline double milliseconds(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}
inline double wall() {
  return milliseconds(CLOCK_MONOTONIC);
}
/// Processor time of the calling thread, without its waits for others.
inline double worked() {
  return milliseconds(CLOCK_THREAD_CPUTIME_ID);
}

/// The longest time that the event loop did not turn, and what it worked meanwhile.
class Heartbeat : public QObject {
 public:
  Heartbeat() {
    connect(&timer_, &QTimer::timeout, this, &Heartbeat::beat);
    timer_.setTimerType(Qt::PreciseTimer);
    timer_.start(1);
    beat();
    longest_ = most_ = 0;
  }
  /// Since the last call.
  std::string take() {
    beat();
    char text[80];
    std::snprintf(text, sizeof text, "longest pause %.0f ms (work in one pause: at most %.0f ms)",
                  longest_, most_);
    longest_ = most_ = 0;
    return text;
  }

 private:
  void beat() {
    const double wall_now = wall(), worked_now = worked();
    longest_ = std::max(longest_, wall_now - wall_);
    most_ = std::max(most_, worked_now - worked_);
    wall_ = wall_now;
    worked_ = worked_now;
  }
  QTimer timer_;
  double wall_ = 0, worked_ = 0, longest_ = 0, most_ = 0;
};

}  // namespace plenoflame::desktop::test
