// Uses the installed library the way a program of somebody else would.
#include <atomic>
#include <cstdio>

#include "plenoflame/base/execution.h"
#include "plenoflame/base/version.h"

int main() {
  plenoflame::Execution execution;
  execution.threads = 2;
  std::atomic<int> runs{0};
  plenoflame::parallel_for(execution, 10, [&](std::size_t, int) { ++runs; });
  std::printf("plenoflame %s\n", std::string(plenoflame::version()).c_str());
  return runs == 10 ? 0 : 1;
}
