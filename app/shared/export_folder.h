#pragma once
#include <string>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/image/light_field.h"
#include "plenoflame/lightfield/export.h"
#include "plenoflame/scene/scene.h"

namespace plenoflame {

/// Export for another tool, as requested by a script.
struct ExportRequest {
  std::string format;   ///< one of export_formats(), by name
  std::string folder;   ///< made when missing, else it must be empty
  std::string name;     ///< stem of the files
  std::string channel;  ///< of grey pictures; empty: the first
  int grid = 0;         ///< views along a side; 0: as the tool expects
  /// Red, green and blue of colour pictures, with commas between; empty: as export_colours()
  std::string channels = {};
};

/// The colours of the pictures. Unless three channels are named, or one for grey pictures, they are
/// those that the scene's channels are, where the tool knows colour.
/// @param scene that the light field holds; nullptr: none
/// @param prefix of options' names in messages: "--"
/// @throws UsageError for names that are not three, or together with `channel`, or for a format
/// without colour
ColourChannels export_colours(const LightField& field, const Scene* scene, const ExportName& format,
                              const std::vector<std::string>& channels, const std::string& channel,
                              const std::string& prefix);

/// Writes all of the files or none.
/// @throws InputError for an unknown format, and as check_export(); UsageError for a grid that the
/// format does not have; FileError for a folder that cannot be made or holds files; Cancelled
ExportResult export_to_folder(const LightField& field, const ExportRequest& request,
                              const Execution& execution);

}  // namespace plenoflame
