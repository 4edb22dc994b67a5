#pragma once
#include <cstdlib>

namespace plenoflame::test {

/// Whether tests run in full (PLENOFLAME_LONG_TESTS=1): minutes, and errors of 0.1 %.
inline bool in_full() {
  return std::getenv("PLENOFLAME_LONG_TESTS") != nullptr;
}

}  // namespace plenoflame::test
