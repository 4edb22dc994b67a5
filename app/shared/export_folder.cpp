#include "export_folder.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "light_field_camera.h"
#include "plenoflame/base/error.h"
#include "plenoflame/image/staging_folder.h"

namespace plenoflame {
namespace {

const ExportName& format_of(const std::string& name) {
  std::string names;
  for (const ExportName& format : export_formats()) {
    if (format.name == name) return format;
    names.append(names.empty() ? "" : ", ").append(format.name);
  }
  throw InputError("there is no format '" + name + "'; there are " + names);
}

/// Makes the folder if need be. @return whether it was made @throws FileError
bool prepare(const std::string& folder) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (!fs::exists(folder, error)) {
    if (!fs::create_directory(folder, error))
      throw FileError("cannot make the folder '" + folder + "': " + error.message());
    return true;
  }
  if (!fs::is_directory(folder, error))
    throw FileError("'" + folder + "' is not a folder; choose another one");
  StagingFolder::remove_abandoned(folder);
  if (!fs::is_empty(folder, error) || error)
    throw FileError("the folder '" + folder + "' has files in it; choose another one");
  return false;
}

std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> words;
  for (std::size_t at = 0; !text.empty() && at <= text.size();) {
    const std::size_t comma = std::min(text.find(',', at), text.size());
    words.push_back(text.substr(at, comma - at));
    at = comma + 1;
  }
  return words;
}

}  // namespace

ColourChannels export_colours(const LightField& field, const Scene* scene, const ExportName& format,
                              const std::vector<std::string>& channels, const std::string& channel,
                              const std::string& prefix) {
  const ColourChannels of_scene = scene ? colour_channels(*scene) : ColourChannels{};
  if (channels.empty()) {
    const auto missing = [&](const std::string& name) {
      return std::none_of(field.channels.begin(), field.channels.end(),
                          [&](const LightFieldChannel& other) { return other.name == name; });
    };
    const bool none = !format.colour || !channel.empty() ||
                      std::any_of(of_scene.names.begin(), of_scene.names.end(), missing);
    return none ? ColourChannels{} : of_scene;
  }
  if (channels.size() != 3)
    throw UsageError(prefix +
                     "channels needs three names, of red, green and blue, separated by commas");
  if (!channel.empty())
    throw UsageError(prefix + "channel is for grey pictures, " + prefix +
                     "channels for colour; give one of them");
  if (!format.colour)
    throw UsageError(prefix + "channels: the format '" + format.name +
                     "' holds one channel; choose it with " + prefix + "channel");
  ColourChannels colours;
  std::copy(channels.begin(), channels.end(), colours.names.begin());
  colours.is_xyz = colours.names == of_scene.names && of_scene.is_xyz;
  return colours;
}

ExportResult export_to_folder(const LightField& field, const ExportRequest& request,
                              const Execution& execution) {
  const ExportName& format = format_of(request.format);
  if (request.grid > 0 && format.grid == 0)
    throw UsageError("grid: the format '" + request.format + "' holds no views");
  const Scene scene = scene_of(field, "the light field").scene;
  check_raw_image(field, scene.camera);
  const Camera camera(scene.camera);
  check_export(camera, format.format);
  ExportSettings settings;
  settings.format = format.format;
  settings.name = request.name;
  settings.grid = request.grid;
  settings.views.channel = request.channel;
  settings.colour =
      export_colours(field, &scene, format, words_of(request.channels), request.channel, "");
  MicroImages micro(camera, true, execution);
  micro.look_through(scene.windows);
  const bool made = prepare(request.folder);
  try {
    StagingFolder staging(request.folder);
    ExportResult result = export_light_field(field, micro, settings, staging.path(), execution);
    staging.commit();
    return result;
  } catch (...) {
    std::error_code error;  // nothing is left of a folder that was made for nothing
    if (made) std::filesystem::remove(request.folder, error);
    throw;
  }
}

}  // namespace plenoflame
