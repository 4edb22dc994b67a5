#pragma once
#include <optional>
#include <string>
#include <string_view>

namespace plenoflame {

/// Refuses text whose dotted keys have more than 32 parts. The TOML library makes one table within
/// the other of them and takes them apart by recursion: a hundred thousand parts, a file of 200 kB,
/// would exhaust the stack. (Nested arrays and inline tables it limits by itself.)
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

/// Refuses what is no text at all, such as a light field in the place of its scene: what a parser
/// of TOML says of it helps nobody. @throws InputError
void check_is_text(std::string_view text, const std::string& name);

}  // namespace plenoflame
