#include "plenoflame/base/available_memory.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>

#include "plenoflame/base/error.h"

namespace plenoflame {

double available_memory() {
  double available = std::numeric_limits<double>::infinity();
  std::ifstream system("/proc/meminfo");
  for (std::string word; system >> word;)
    if (double kilobytes = 0; word == "MemAvailable:" && system >> kilobytes) {
      available = 1024 * kilobytes;
      break;
    }
  rlimit limit{};
  double pages = 0;
  if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY &&
      std::ifstream("/proc/self/statm") >> pages) {
    const double taken = pages * static_cast<double>(sysconf(_SC_PAGESIZE));
    available = std::min(available, std::max(static_cast<double>(limit.rlim_cur) - taken, 0.0));
  }
  return available;
}

void require_memory(double bytes, const std::string& what, const std::string& advice) {
  const double available = available_memory();
  if (bytes <= available) return;
  const auto gigabytes = [](double value) {
    return value < 1e11 ? fmt::format("{:.2g}", value / 1e9) : fmt::format("{:.0f}", value / 1e9);
  };
  throw InputError(fmt::format("{} would take some {} GB of memory, and {} GB are to be had: {}",
                               what, gigabytes(bytes), gigabytes(available), advice));
}

}  // namespace plenoflame
