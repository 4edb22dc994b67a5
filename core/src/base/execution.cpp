#include "plenoflame/base/execution.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace plenoflame {

int Execution::thread_count() const {
  if (threads > 0) return threads;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

bool parallel_for(const Execution& execution, std::size_t count,
                  const std::function<void(std::size_t, int)>& task) {
  std::atomic<std::size_t> next{0};
  std::atomic<bool> failed{false};
  std::mutex mutex;
  std::exception_ptr first_failure;
  const auto work = [&](int worker) {
    while (!failed.load(std::memory_order_relaxed) && !execution.stop.stop_requested()) {
      const std::size_t index = next.fetch_add(1);
      if (index >= count) return;
      try {
        task(index, worker);
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!first_failure) first_failure = std::current_exception();
        failed = true;
      }
    }
  };
  const auto workers = static_cast<int>(std::min<std::size_t>(
      static_cast<std::size_t>(execution.thread_count()), std::max<std::size_t>(count, 1)));
  {
    std::vector<std::jthread> pool;
    try {
      for (int worker = 1; worker < workers; ++worker) pool.emplace_back(work, worker);
    } catch (const std::system_error&) {
      // The system gives no more threads: those that there are do the work.
    }
    work(0);
  }
  if (first_failure) std::rethrow_exception(first_failure);
  return next.load() >= count;
}

}  // namespace plenoflame
