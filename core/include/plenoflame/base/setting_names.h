#pragma once
#include <string>
#include <string_view>

namespace plenoflame {

class Error;

/// How a caller writes the names of settings, so that messages name them as it does. By default
/// they are arguments of functions: absorption_error, solver='mart'.
struct SettingNames {
  std::string_view prefix = "";
  char separator = '_';     ///< between words
  bool is_argument = true;  ///< values are assigned

  /// @param setting its own name, words with hyphens: "absorption-error"
  std::string operator()(std::string_view setting) const;
  /// The setting with its value.
  std::string operator()(std::string_view setting, std::string_view value) const;
  /// The text of an error, with the settings that mend it: "... (region, margin)".
  std::string message(const Error& error) const;
};

}  // namespace plenoflame
