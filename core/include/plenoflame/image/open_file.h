#pragma once
#include <cstdio>
#include <string>

namespace plenoflame {

/// Opens a file for reading, and never waits for that: a named pipe into which nobody writes is
/// refused. @return to be closed by fclose() @throws FileError naming path and cause
std::FILE* open_for_reading(const std::string& path);

}  // namespace plenoflame
