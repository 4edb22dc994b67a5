#include "interrupt.h"

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <ctime>

#include "plenoflame/base/error.h"

namespace plenoflame::cli {
namespace {

// A signal handler can reach only globals. It must not request a stop, which may lock and run
// callbacks. It writes one byte, and a waiting thread does the rest.
std::atomic<int> write_end{-1};
/// [ms] of the monotonic clock when the first signal came; 0: none did.
std::atomic<std::int64_t> first_signal{0};
static_assert(std::atomic<int>::is_always_lock_free);
static_assert(std::atomic<std::int64_t>::is_always_lock_free);
/// Ctrl-C, a request to end, and a terminal or connection that went away.
constexpr std::array<int, 3> kSignals{SIGINT, SIGTERM, SIGHUP};
std::array<struct sigaction, kSignals.size()> previous_actions;

/// [ms] What sends a signal to a process and to its group, such as timeout(1), means one.
constexpr std::int64_t kTogether = 300;

constexpr char kSignal = 's';
constexpr char kEnd = 'e';

extern "C" void plenoflame_on_signal(int number) {
  const int saved = errno;
  timespec clock{};
  clock_gettime(CLOCK_MONOTONIC, &clock);
  const std::int64_t now = std::int64_t{clock.tv_sec} * 1000 + clock.tv_nsec / 1000000;
  std::int64_t first = 0;
  if (first_signal.compare_exchange_strong(first, now)) {
    const ssize_t written = write(write_end.load(), &kSignal, 1);
    static_cast<void>(written);
  } else if (now - first > kTogether) {
    signal(number, SIG_DFL);  // delivered again, with its usual effect, when this handler returns
    raise(number);
  }
  errno = saved;
}

}  // namespace

void InterruptHandler::watch() {
  watcher_ = std::jthread([source = stop_, read_end = read_end_]() mutable {
    char what = 0;
    for (;;) {
      const ssize_t count = read(read_end, &what, 1);
      if (count < 0 && errno == EINTR) continue;
      if (count == 1 && what == kSignal) {
        source.request_stop();
        continue;
      }
      return;
    }
  });
}

InterruptHandler::InterruptHandler() {
  if (write_end.load() >= 0) throw Error("there is an interrupt handler already");
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw Error("no pipe for the interrupt handler");
  read_end_ = ends[0];
  first_signal = 0;
  try {
    watch();
  } catch (...) {  // no thread to be had
    close(ends[0]);
    close(ends[1]);
    throw;
  }
  write_end = ends[1];
  struct sigaction action {};
  action.sa_handler = plenoflame_on_signal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  for (std::size_t i = 0; i < kSignals.size(); ++i)
    sigaction(kSignals[i], nullptr, &previous_actions[i]);
  for (std::size_t i = 0; i < kSignals.size(); ++i)
    // nohup(1) has SIGHUP ignored, a shell SIGINT of what runs behind: that is respected.
    if (previous_actions[i].sa_handler != SIG_IGN) sigaction(kSignals[i], &action, nullptr);
}

void InterruptHandler::ignore_from_now() {
  for (const int number : kSignals) signal(number, SIG_IGN);
  restores_ = false;
}

InterruptHandler::~InterruptHandler() {
  for (std::size_t i = 0; restores_ && i < kSignals.size(); ++i)
    sigaction(kSignals[i], &previous_actions[i], nullptr);
  const int end = write_end.load();
  const ssize_t written = write(end, &kEnd, 1);
  static_cast<void>(written);
  watcher_.join();
  write_end = -1;
  close(end);
  close(read_end_);
}

}  // namespace plenoflame::cli
