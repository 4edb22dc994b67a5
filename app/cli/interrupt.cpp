#include "interrupt.h"

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdint>
#include <ctime>

#include "plenoflame/base/error.h"

namespace plenoflame::cli {
namespace {

// A signal handler can reach nothing but globals. Requesting a stop may lock and run callbacks,
// which a handler must not do: it writes one byte, and a thread that waits for it does the rest.
std::atomic<int> write_end{-1};
/// [ms] of the monotonic clock when the first signal came; 0: none did.
std::atomic<std::int64_t> first_signal{0};
static_assert(std::atomic<int>::is_always_lock_free);
static_assert(std::atomic<std::int64_t>::is_always_lock_free);
struct sigaction previous_interrupt;
struct sigaction previous_terminate;

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

InterruptHandler::InterruptHandler() {
  if (write_end.load() >= 0) throw Error("there is an interrupt handler already");
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw Error("no pipe for the interrupt handler");
  read_end_ = ends[0];
  first_signal = 0;
  write_end = ends[1];
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
  struct sigaction action {};
  action.sa_handler = plenoflame_on_signal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  sigaction(SIGINT, &action, &previous_interrupt);
  sigaction(SIGTERM, &action, &previous_terminate);
}

InterruptHandler::~InterruptHandler() {
  sigaction(SIGINT, &previous_interrupt, nullptr);
  sigaction(SIGTERM, &previous_terminate, nullptr);
  const int end = write_end.load();
  const ssize_t written = write(end, &kEnd, 1);
  static_cast<void>(written);
  watcher_.join();
  write_end = -1;
  close(end);
  close(read_end_);
}

}  // namespace plenoflame::cli
