#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace plenoflame {

/// Numbers of a line of a text file.
struct NumberRow {
  int line = 0;  ///< from 1
  std::vector<double> values;
};

/// Reads lines of `count` finite numbers with commas between. Comments begin with #; empty lines
/// and a header of words are skipped.
/// @param what the line should be, for the message, e.g. "a point: x,y,z in metres"
/// @throws InputError with the line, and for a file without any; FileError
std::vector<NumberRow> read_number_rows(const std::string& path, std::size_t count,
                                        std::string_view what);

}  // namespace plenoflame
