#include <unistd.h>

#include <exception>
#include <string_view>

#include "run.h"

namespace {

[[noreturn]] void cannot_start() {
  constexpr std::string_view kText =
      "plenoflame: error: the limit on processes or on memory (ulimit -u, -v) is too low to "
      "start\n";
  static_cast<void>(!write(STDERR_FILENO, kText.data(), kText.size()));
  _exit(1);
}

void expect_no_start() {
  std::set_terminate(cannot_start);
}

/// Called before the libraries are initialised. log4cplus, which OpenVDB uses, starts threads then.
/// If the system cannot start a thread, the exception is thrown outside of any handler.
[[gnu::section(".preinit_array"), gnu::used]] void (*const before_libraries)() = expect_no_start;

}  // namespace

int main(int argc, char** argv) {
  std::set_terminate(__gnu_cxx::__verbose_terminate_handler);
  return plenoflame::cli::run(argc, argv);
}
