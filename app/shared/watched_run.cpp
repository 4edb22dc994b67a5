#include "watched_run.h"

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <new>
#include <stop_token>
#include <thread>
#include <utility>

#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

/// News from the worker to the thread that waits for it.
struct Mailbox {
  std::mutex mutex;
  std::condition_variable changed;
  double fraction = 0;
  bool done = false;
  std::vector<std::string> warnings;
  std::exception_ptr failure;
};

}  // namespace

std::string message_of_current_exception(const SettingNames& names) {
  try {
    throw;
  } catch (const std::bad_alloc&) {
    return "not enough memory";
  } catch (const Error& error) {
    return names.message(error);
  } catch (const std::exception& error) {
    return error.what();
  } catch (...) {
    return "unknown failure";
  }
}

void watched_run(int threads, const std::function<bool(double)>& watch,
                 std::vector<std::string>& warnings,
                 const std::function<void(const Execution&)>& task) {
  constexpr auto kPoll = std::chrono::milliseconds(50);
  Mailbox mailbox;
  std::stop_source stop;
  Execution execution;
  execution.threads = threads;
  execution.stop = stop.get_token();
  execution.progress = [&](const Progress& progress) {
    const std::lock_guard lock(mailbox.mutex);
    mailbox.fraction = progress.fraction;
    mailbox.changed.notify_one();
  };
  execution.message = [&](Severity severity, const std::string& text) {
    if (severity != Severity::warning) return;
    const std::lock_guard lock(mailbox.mutex);
    mailbox.warnings.push_back(text);
  };
  std::thread worker([&] {
    std::exception_ptr failure;
    try {
      task(execution);
    } catch (...) {
      failure = std::current_exception();
    }
    const std::lock_guard lock(mailbox.mutex);
    mailbox.failure = failure;
    mailbox.done = true;
    mailbox.changed.notify_one();
  });
  double shown = 0;
  while (true) {
    {
      std::unique_lock lock(mailbox.mutex);
      mailbox.changed.wait_for(lock, kPoll,
                               [&] { return mailbox.done || mailbox.fraction > shown; });
      if (mailbox.done) break;
      shown = mailbox.fraction;
    }
    // Without news, too: who watches may want to stop.
    if (watch(shown)) stop.request_stop();
  }
  worker.join();
  warnings = std::move(mailbox.warnings);
  if (mailbox.failure) std::rethrow_exception(mailbox.failure);
}

}  // namespace plenoflame
