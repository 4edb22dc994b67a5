#include "progress_bar.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iostream>

#include "plenoflame/base/printable.h"

namespace plenoflame::cli {
namespace {

std::string format(const char* pattern, double value) {
  char text[64];
  std::snprintf(text, sizeof text, pattern, value);
  return text;
}

std::string format_rate(double per_second) {
  if (per_second >= 1e9) return format("%.3g G rays/s", per_second / 1e9);
  if (per_second >= 1e6) return format("%.3g M rays/s", per_second / 1e6);
  if (per_second >= 1e3) return format("%.3g k rays/s", per_second / 1e3);
  return format("%.0f rays/s", per_second);
}

bool draws_on_terminal() {
  const char* kind = std::getenv("TERM");
  return isatty(STDERR_FILENO) == 1 && !(kind != nullptr && std::string(kind) == "dumb");
}

int terminal_columns() {
  winsize size{};
  if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  return 80;
}

}  // namespace

std::string format_duration(double seconds) {
  if (!(seconds >= 0) || seconds > 1e9) return "unknown";
  const auto total = static_cast<long long>(std::ceil(seconds));
  const long long hours = total / 3600, minutes = total / 60 % 60, rest = total % 60;
  char text[64];
  if (hours > 0)
    std::snprintf(text, sizeof text, "%lld:%02lld:%02lld", hours, minutes, rest);
  else
    std::snprintf(text, sizeof text, "%lld:%02lld", minutes, rest);
  return text;
}

std::string progress_line(const Progress& progress, int columns, const std::string& label) {
  const double fraction = std::clamp(progress.fraction, 0.0, 1.0);
  constexpr int kBar = 24;
  const int filled = static_cast<int>(fraction * kBar);
  // Rounded down: 100 % is shown only when everything is done.
  std::string line = label + (label.empty() ? "" : ": ");
  line += format("%3.0f %% [", std::floor(100 * fraction));
  line += std::string(static_cast<std::size_t>(filled), '#') +
          std::string(static_cast<std::size_t>(kBar - filled), '.') + ']';
  if (progress.rays_per_second > 0) line += "  " + format_rate(progress.rays_per_second);
  if (progress.relative_error >= 0)
    line += "  error " + format("%.2g %%", 100 * progress.relative_error);
  if (progress.remaining_seconds >= 0)
    line += "  " + format_duration(progress.remaining_seconds) + " left";
  if (columns > 0 && line.size() > static_cast<std::size_t>(columns))
    line.resize(static_cast<std::size_t>(columns));
  return line;
}

ProgressBar::ProgressBar(bool quiet)
    : ProgressBar(std::cerr, draws_on_terminal(), quiet, terminal_columns()) {}

ProgressBar::ProgressBar(std::ostream& stream, bool is_terminal, bool quiet, int columns)
    : stream_(stream), drawing_(is_terminal && !quiet), quiet_(quiet), columns_(columns) {}

ProgressBar::~ProgressBar() {
  finish();
}

void ProgressBar::begin(const std::string& label) {
  const std::lock_guard lock(mutex_);
  label_ = label;
  last_ = {};
  begun_ = std::chrono::steady_clock::now();
  fraction_ = 0;
}

/// [s] negative: not known yet.
double ProgressBar::remaining(double fraction, std::chrono::steady_clock::time_point now) {
  constexpr double kLeastShare = 0.05, kLeastSeconds = 1;
  if (fraction < 0.5 * fraction_) begun_ = now;  // threads may report a little out of order
  fraction_ = fraction;
  const double taken = std::chrono::duration<double>(now - begun_).count();
  if (fraction < kLeastShare || taken < kLeastSeconds) return -1;
  return taken * (1 - fraction) / fraction;
}

void ProgressBar::update(const Progress& progress) {
  if (!drawing_) return;
  const std::lock_guard lock(mutex_);
  const auto now = std::chrono::steady_clock::now();
  Progress told = progress;
  const double by_share = remaining(progress.fraction, now);
  if (told.remaining_seconds < 0) told.remaining_seconds = by_share;
  if (visible_ && progress.fraction < 1 && now - last_ < std::chrono::milliseconds(100)) return;
  last_ = now;
  // One column is left free: some terminals wrap when the last one is used.
  stream_ << '\r' << progress_line(told, columns_ - 1, label_) << "\x1b[K" << std::flush;
  visible_ = true;
}

void ProgressBar::message(Severity severity, const std::string& text) {
  if (quiet_ && severity == Severity::note) return;
  const std::lock_guard lock(mutex_);
  clear();
  stream_ << "plenoflame: " << (severity == Severity::warning ? "warning" : "note") << ": "
          << printable(text) << std::endl;
}

void ProgressBar::finish() {
  const std::lock_guard lock(mutex_);
  clear();
}

void ProgressBar::clear() {
  if (!visible_) return;
  stream_ << "\r\x1b[K" << std::flush;
  visible_ = false;
}

void ProgressBar::connect(Execution& execution) {
  execution.progress = [this](const Progress& progress) { update(progress); };
  execution.message = [this](Severity severity, const std::string& text) {
    message(severity, text);
  };
}

}  // namespace plenoflame::cli
