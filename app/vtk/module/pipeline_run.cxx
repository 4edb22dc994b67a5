#include "pipeline_run.h"

#include <vtkAlgorithm.h>
#include <vtkSetGet.h>

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <new>
#include <stop_token>
#include <thread>
#include <vector>

#include "plenoflame/base/error.h"

namespace plenoflame::pipeline {
namespace {

/// The message of the exception being handled.
std::string message_of_current() {
  try {
    throw;
  } catch (const std::bad_alloc&) {
    return "not enough memory";
  } catch (const std::exception& error) {
    return error.what();
  } catch (...) {
    return "unknown failure";
  }
}

/// What the worker tells the thread that waits for it.
struct Mailbox {
  std::mutex mutex;
  std::condition_variable changed;
  double fraction = 0;
  bool done = false;
  std::vector<std::string> warnings;
  std::exception_ptr failure;
};

}  // namespace

void report_error(vtkObject& object, const std::string& message) {
  vtkErrorWithObjectMacro(&object, << message);
}

void report_warning(vtkObject& object, const std::string& message) {
  vtkWarningWithObjectMacro(&object, << message);
}

bool run_here(vtkObject& object, const std::function<void()>& task) {
  try {
    task();
    return true;
  } catch (const Cancelled&) {
    return false;
  } catch (...) {
    report_error(object, message_of_current());
    return false;
  }
}

bool run(vtkAlgorithm& algorithm, int threads, const std::function<void(const Execution&)>& task) {
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
  algorithm.SetAbortExecute(0);
  algorithm.UpdateProgress(0);
  std::thread worker([&] {
    try {
      task(execution);
    } catch (...) {
      mailbox.failure = std::current_exception();
    }
    const std::lock_guard lock(mailbox.mutex);
    mailbox.done = true;
    mailbox.changed.notify_one();
  });
  double shown = 0;
  for (bool done = false; !done;) {
    double fraction = 0;
    {
      std::unique_lock lock(mailbox.mutex);
      mailbox.changed.wait_for(lock, kPoll,
                               [&] { return mailbox.done || mailbox.fraction > shown; });
      done = mailbox.done;
      fraction = mailbox.fraction;
    }
    if (done) break;
    // Without news, too: an observer may want to abort.
    shown = fraction;
    algorithm.UpdateProgress(shown);
    if (algorithm.GetAbortExecute()) stop.request_stop();
  }
  worker.join();
  for (const std::string& warning : mailbox.warnings) report_warning(algorithm, warning);
  const bool finished = run_here(algorithm, [&] {
    if (mailbox.failure) std::rethrow_exception(mailbox.failure);
  });
  if (finished) algorithm.UpdateProgress(1);
  return finished;
}

}  // namespace plenoflame::pipeline
