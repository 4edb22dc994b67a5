#pragma once
#include <stop_token>
#include <thread>

namespace plenoflame::cli {

/// While it exists, the first SIGINT (Ctrl-C), SIGTERM or SIGHUP requests a stop. Another signal at
/// least 0.3 s later ends the process at once, as without a handler. A signal that was ignored
/// before stays ignored. Only one object at a time.
class InterruptHandler {
 public:
  /// @throws Error when the handlers cannot be installed, std::system_error when there is no thread
  InterruptHandler();
  ~InterruptHandler();
  InterruptHandler(const InterruptHandler&) = delete;
  InterruptHandler& operator=(const InterruptHandler&) = delete;

  std::stop_token token() const { return stop_.get_token(); }
  /// The work is done and stands: ignores signals from here on, also after this object is gone.
  /// Otherwise one in the last moment would end a process whose results are there as a failure.
  void ignore_from_now();
  /// True if a signal came.
  bool interrupted() const { return stop_.stop_requested(); }

 private:
  void watch();

  std::stop_source stop_;
  int read_end_ = -1;
  bool restores_ = true;  ///< what was there before
  std::jthread watcher_;
};

}  // namespace plenoflame::cli
