#include "base/large_pages.h"

#include <cstdint>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace plenoflame {

void prefer_large_pages([[maybe_unused]] void* begin, [[maybe_unused]] std::size_t bytes) {
#if defined(__linux__)
  // Only what lies within large pages: what is next to it belongs to others.
  constexpr std::uintptr_t kLarge = std::uintptr_t{1} << 21;
  const auto at = reinterpret_cast<std::uintptr_t>(begin);
  const std::uintptr_t first = (at + kLarge - 1) / kLarge * kLarge;
  const std::uintptr_t end = (at + bytes) / kLarge * kLarge;
  // It is a hint: failure changes nothing.
  if (end > first) madvise(static_cast<char*>(begin) + (first - at), end - first, MADV_HUGEPAGE);
#endif
}

}  // namespace plenoflame
