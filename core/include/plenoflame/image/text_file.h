#pragma once
#include <string>

namespace plenoflame {

/// Reads a file of text, without the mark that UTF-8 may begin with.
/// @throws FileError as read_file(), InputError for UTF-16 and UTF-32
std::string read_text_file(const std::string& path);

}  // namespace plenoflame
