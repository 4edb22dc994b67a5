#include "scene/files/parse_toml.h"

#include <algorithm>

#include "plenoflame/base/error.h"
#include "scene/files/toml_guard.h"

namespace plenoflame {

toml::table parse_toml(std::string_view text, const std::string& name) {
  check_is_text(text, name);
  check_key_depth(text, name);
  try {
    return toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    const auto& source = error.source();
    const auto open = find_open_string(text);
    if (open && open->line <= static_cast<int>(source.begin.line))
      throw InputError({name, open->line, open->column},
                       "the text that begins here has no closing " +
                           std::string(open->long_form ? 3 : 1, open->quote));
    std::string message(error.description());
    std::replace(message.begin(), message.end(), '\n', ' ');
    throw InputError(
        {name, static_cast<int>(source.begin.line), static_cast<int>(source.begin.column)},
        "this is not TOML: " + message);
  }
}

}  // namespace plenoflame
