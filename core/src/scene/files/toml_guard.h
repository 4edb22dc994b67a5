#pragma once
#include <optional>
#include <string>
#include <string_view>

namespace plenoflame {

/// Rejects text whose dotted keys have more than 32 parts. The TOML library nests one table per
/// part and destroys them by recursion. A hundred thousand parts, a file of 200 kB, would exhaust
/// the stack. (The library itself limits nested arrays and inline tables.)
/// @param name of the file, for the message. @throws InputError
void check_key_depth(std::string_view text, const std::string& name);

/// The place where a string begins that has no closing quote. Line and column count from 1.
struct OpenString {
  int line = 1, column = 1;
  char quote = '"';
  bool long_form = false;  ///< three quotes
};

/// The first string of a text that is not closed: on its line, or anywhere when it has three
/// quotes. For texts that the TOML parser has rejected.
std::optional<OpenString> find_open_string(std::string_view text);

/// Rejects a file that is not text, such as a light field in place of its scene: the TOML parser's
/// message would not help.
/// @throws InputError
void check_is_text(std::string_view text, const std::string& name);

}  // namespace plenoflame
