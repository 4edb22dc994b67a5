#pragma once
#include <string>

#include "plenoflame/base/execution.h"
#include "plenoflame/image/light_field.h"
#include "plenoflame/lightfield/export.h"

namespace plenoflame {

/// Files of another tool, as a script asks for them.
struct ExportRequest {
  std::string format;   ///< one of export_formats(), by name
  std::string folder;   ///< made when missing, else it must be empty
  std::string name;     ///< stem of the files
  std::string channel;  ///< empty: the first
  int grid = 0;         ///< views along a side; 0: as the tool expects
};

/// Writes all of the files or none.
/// @throws InputError for an unknown format, and as check_export(); UsageError for a grid that the
/// format does not have; FileError for a folder that cannot be made or holds files; Cancelled
ExportResult export_to_folder(const LightField& field, const ExportRequest& request,
                              const Execution& execution);

}  // namespace plenoflame
