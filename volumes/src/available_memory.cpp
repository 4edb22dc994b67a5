#include "available_memory.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>

namespace plenoflame::detail {

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

}  // namespace plenoflame::detail
