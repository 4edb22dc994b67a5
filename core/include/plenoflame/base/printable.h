#pragma once
#include <string>
#include <string_view>

namespace plenoflame {

/// Text from a file as it can be shown on a terminal or in a log without acting there: control
/// characters (C0, DEL, C1), line and paragraph separators and the marks that turn the direction
/// of writing become `\u001b` and the like, bytes that are not UTF-8 `\xe9`. In strings of JSON
/// and TOML the former mean the same characters.
/// @param keep_lines line ends and tabs stay as they are
std::string printable(std::string_view text, bool keep_lines = false);

}  // namespace plenoflame
