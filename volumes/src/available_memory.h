#pragma once

namespace plenoflame::detail {

/// [byte] that the process may still take: what the system has left, and what a limit on its
/// address space leaves (ulimit -v). Infinite where neither is known.
double available_memory();

}  // namespace plenoflame::detail
