#pragma once
#include <chrono>
#include <iosfwd>
#include <mutex>
#include <string>

#include "plenoflame/base/execution.h"

namespace plenoflame::cli {

/// "0:07", "12:34", "3:05:00"; rounds up, so that the last second does not read 0:00.
std::string format_duration(double seconds);

/// One line without a line break: percentage, bar, rays per second, error reached, remaining time;
/// what is not known yet is left out. At most `columns` characters.
/// @param label of what is under way, before all else; empty: none
std::string progress_line(const Progress& progress, int columns, const std::string& label = "");

/// Progress and messages of a run on one stream. If work does not report its remaining time, the
/// bar estimates it from the time of the completed share. The progress line is drawn only on a
/// terminal, at most ten times per second. Messages ("plenoflame: warning: ...") always appear on
/// their own lines. Safe to call from several threads.
class ProgressBar {
 public:
  /// Standard error. @param quiet draws no progress and no notes; warnings remain
  explicit ProgressBar(bool quiet);
  /// For tests. @param columns width of the terminal
  ProgressBar(std::ostream& stream, bool is_terminal, bool quiet, int columns);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// Another part of the work begins, whose progress goes from 0 to 1 on its own.
  void begin(const std::string& label);
  void update(const Progress& progress);
  void message(Severity severity, const std::string& text);
  /// Removes the progress line; nothing of it remains.
  void finish();

  /// Sets `execution`'s progress and message to this; it must outlive the run.
  void connect(Execution& execution);

 private:
  void clear();
  double remaining(double fraction, std::chrono::steady_clock::time_point now);

  std::ostream& stream_;
  bool drawing_;
  bool quiet_;
  int columns_;
  bool visible_ = false;
  std::string label_;
  std::chrono::steady_clock::time_point last_{}, begun_ = std::chrono::steady_clock::now();
  double fraction_ = 0;  ///< of the last update: less than half of that is another part
  std::mutex mutex_;
};

}  // namespace plenoflame::cli
