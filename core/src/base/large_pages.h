#pragma once
#include <cstddef>

namespace plenoflame {

/// Asks for large pages in memory that has been allocated and not been written to: it is got some
/// times faster. Without effect where the system has none.
void prefer_large_pages(void* begin, std::size_t bytes);

}  // namespace plenoflame
