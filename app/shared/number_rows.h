#pragma once
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "plenoflame/base/error.h"

namespace plenoflame {

/// Numbers of a line of a text file, or of a row of an array.
struct NumberRow {
  SourcePosition at;  ///< for messages
  std::vector<double> values;

  /// @throws InputError where the number in this column is not a whole one
  int whole(std::size_t column) const;
};

/// Reads lines of finite numbers with commas between. Comments begin with #; empty lines and a
/// header of words are skipped.
/// @param counts numbers of a line; all lines have as many as the first
/// @param what the line should be, for the message, e.g. "a point: x,y,z in metres"
/// @throws InputError with the line, and for a file without any; FileError
std::vector<NumberRow> read_number_rows(const std::string& path,
                                        std::initializer_list<std::size_t> counts,
                                        std::string_view what);

}  // namespace plenoflame
