#pragma once
#include <sys/mman.h>
#include <unistd.h>
#include <csignal>
#include <cstdint>
#include <stdexcept>
#include <stop_token>

namespace plenoflame::test {

/// Requests a stop when somebody first reads at an address: writers of files are stopped in the
/// midst of their work, at the same place each time. The page around it is closed until then, so it
/// must lie within what belongs to the data alone: in the middle of at least three pages.
class StopOnRead {
 public:
  explicit StopOnRead(const void* address) {
    size_ = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    const auto place = reinterpret_cast<std::uintptr_t>(address);
    page_ = reinterpret_cast<void*>(place / size_ * size_);
    source_ = std::stop_source();
    struct sigaction action {};
    action.sa_sigaction = &open_page;
    action.sa_flags = SA_SIGINFO;
    sigaction(SIGSEGV, &action, &before_);
    if (mprotect(page_, size_, PROT_NONE) != 0) throw std::runtime_error("no page to close");
  }
  ~StopOnRead() {
    mprotect(page_, size_, PROT_READ | PROT_WRITE);
    sigaction(SIGSEGV, &before_, nullptr);
  }
  StopOnRead(const StopOnRead&) = delete;
  StopOnRead& operator=(const StopOnRead&) = delete;

  std::stop_token token() const { return source_.get_token(); }

 private:
  static void open_page(int, siginfo_t* info, void*) {
    const auto place = reinterpret_cast<std::uintptr_t>(info->si_addr);
    if (place / size_ * size_ != reinterpret_cast<std::uintptr_t>(page_)) {
      sigaction(SIGSEGV, &before_,
                nullptr);  // somebody else's: happens again, and ends as it would
      return;
    }
    source_.request_stop();
    mprotect(page_, size_, PROT_READ | PROT_WRITE);
  }

  static inline void* page_ = nullptr;
  static inline std::size_t size_ = 0;
  static inline std::stop_source source_;
  static inline struct sigaction before_ {};
};

}  // namespace plenoflame::test
