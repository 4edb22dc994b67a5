#pragma once
#include <optional>
#include <string>
#include <vector>

#include "plenoflame/base/error.h"

namespace plenoflame {

/// A setting of a request in a file.
struct FileSetting {
  std::string key;
  std::vector<std::string> values;  ///< as texts; several of a list
  SourcePosition position;          ///< of the key
};

/// The settings of a table [NAME], the only one of a TOML file, in their order. Nothing: the file
/// has no such table. A list within a list is one text with commas.
/// @throws FileError; InputError for a file that is no TOML, for anything beside the table, for
/// tables within, and if NAME is no table
std::optional<std::vector<FileSetting>> read_settings(const std::string& path,
                                                      const std::string& table);

}  // namespace plenoflame
