#pragma once
#include <QMetaObject>
#include <QObject>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <stop_token>
#include <thread>

namespace plenoflame::desktop {

/// Who goes first when there is more to do than processors.
enum class Urgency {
  waited_for,  ///< somebody looks at the place where it appears: the rays of a click
  work,        ///< a picture that is being made
  in_reserve,  ///< work that is needed later, or only perhaps
};

/// Runs tasks one at a time on a thread of its own, below the priority of the window. Only the
/// latest request matters: it replaces one that waits and asks the one that runs to stop.
///
/// A task catches its own exceptions; one that gets out goes to `on_failure`, on the worker thread.
class LatestTask {
 public:
  using Task = std::function<void(std::stop_token)>;

  explicit LatestTask(Urgency urgency, std::function<void(const std::string&)> on_failure = {});
  /// Asks the running task to stop and waits for it.
  ~LatestTask();
  LatestTask(const LatestTask&) = delete;
  LatestTask& operator=(const LatestTask&) = delete;

  void request(Task task);
  /// Drops what waits and asks what runs to stop; does not wait.
  void cancel();
  /// True while something runs or waits.
  bool busy() const;

 private:
  void run();

  Urgency urgency_;
  std::function<void(const std::string&)> on_failure_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  Task waiting_;
  std::stop_source running_;
  bool is_running_ = false, ending_ = false;
  std::thread thread_;
};

/// Calls `function` on the receiver's thread; not at all when the receiver is gone by then.
template <class Function>
void post(QObject* receiver, Function function) {
  QMetaObject::invokeMethod(receiver, std::move(function), Qt::QueuedConnection);
}

}  // namespace plenoflame::desktop
