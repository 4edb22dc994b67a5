#pragma once
#include <string>

namespace plenoflame {

/// [byte] that the process may still take: what the system has left, and what a limit on its
/// address space leaves (ulimit -v). Infinite where neither is known.
double available_memory();

/// Before memory is taken that the system may not have: it lends more than it has, and ends the
/// process when that is written to.
/// @param bytes that will be taken @param what takes them, the subject of the message
/// @param advice what to do about it @throws InputError
void require_memory(double bytes, const std::string& what, const std::string& advice);

}  // namespace plenoflame
