#pragma once
#include <string>
#include <string_view>

namespace plenoflame {

/// Makes text from a file safe to show on a terminal or in a log. Control characters (C0, DEL, C1),
/// line and paragraph separators and marks of writing direction become `\u001b` and the like. Bytes
/// that are not UTF-8 become `\xe9` and the like. In strings of JSON and TOML the \u form means the
/// same character.
/// @param keep_lines line ends and tabs stay as they are
std::string printable(std::string_view text, bool keep_lines = false);

}  // namespace plenoflame
