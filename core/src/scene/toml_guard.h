#pragma once
#include <string>
#include <string_view>

namespace plenoflame {

/// Refuses text whose dotted keys have more than 32 parts. The TOML library makes one table within
/// the other of them and takes them apart by recursion: a hundred thousand parts, a file of 200 kB,
/// would exhaust the stack. (Nested arrays and inline tables it limits by itself.)
/// @param name of the file, for the message. @throws InputError
void check_key_depth(std::string_view text, const std::string& name);

}  // namespace plenoflame
