#include "model/jobs/latest_task.h"

#include <sys/resource.h>

#include <exception>
#include <utility>

namespace plenoflame::desktop {

LatestTask::LatestTask(Urgency urgency, std::function<void(const std::string&)> on_failure)
    : urgency_(urgency), on_failure_(std::move(on_failure)), thread_([this] { run(); }) {}

LatestTask::~LatestTask() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
    waiting_ = nullptr;
    running_.request_stop();
  }
  wake_.notify_one();
  thread_.join();
}

void LatestTask::request(Task task) {
  {
    const std::lock_guard lock(mutex_);
    waiting_ = std::move(task);
    running_.request_stop();
  }
  wake_.notify_one();
}

void LatestTask::cancel() {
  const std::lock_guard lock(mutex_);
  waiting_ = nullptr;
  running_.request_stop();
}

bool LatestTask::busy() const {
  const std::lock_guard lock(mutex_);
  return is_running_ || waiting_;
}

void LatestTask::run() {
#ifdef __linux__
  // The priority is of this thread alone, and of those that it starts: the window stays quick while
  // all cores work.
  setpriority(PRIO_PROCESS, 0,
              urgency_ == Urgency::waited_for ? 1
              : urgency_ == Urgency::work     ? 8
                                              : 13);
#endif
  std::unique_lock lock(mutex_);
  for (;;) {
    wake_.wait(lock, [&] { return ending_ || waiting_; });
    if (ending_) return;
    const Task task = std::exchange(waiting_, nullptr);
    running_ = std::stop_source();
    is_running_ = true;
    const std::stop_token token = running_.get_token();
    lock.unlock();
    try {
      task(token);
    } catch (const std::exception& error) {
      if (on_failure_) on_failure_(error.what());
    } catch (...) {
      if (on_failure_) on_failure_("unknown failure");
    }
    lock.lock();
    is_running_ = false;
  }
}

}  // namespace plenoflame::desktop
