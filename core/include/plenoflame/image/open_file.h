#pragma once
#include <cstdio>
#include <string>

namespace plenoflame {

/// Opens a file for reading without ever waiting: a named pipe without writer is rejected.
/// @return to be closed by fclose() @throws FileError naming path and cause
std::FILE* open_for_reading(const std::string& path);

}  // namespace plenoflame
