#pragma once
#include <toml++/toml.h>

#include <string>
#include <string_view>

namespace plenoflame {

/// TOML as a table. @param name of the file, for messages @throws InputError with line and column
toml::table parse_toml(std::string_view text, const std::string& name);

}  // namespace plenoflame
