#include "peak_memory.h"

#include <sys/resource.h>

#include <fstream>
#include <string>

namespace plenoflame::cli {

void reset_peak_memory() {
  // Documented in proc(5): 5 resets the peak resident set size.
  std::ofstream("/proc/self/clear_refs") << "5";
}

double peak_memory() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.rfind("VmHWM:", 0) == 0) return 1024 * std::stod(line.substr(6));
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024 * static_cast<double>(usage.ru_maxrss);
}

}  // namespace plenoflame::cli
