#include "export_folder.h"

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
  if (!fs::is_empty(folder, error) || error)
    throw FileError("the folder '" + folder + "' has files in it; choose another one");
  return false;
}

}  // namespace

ExportResult export_to_folder(const LightField& field, const ExportRequest& request,
                              const Execution& execution) {
  const ExportName& format = format_of(request.format);
  if (request.grid > 0 && format.grid == 0)
    throw UsageError("grid: the format '" + request.format + "' holds no views");
  const Camera camera(camera_of(field));
  check_export(camera, format.format);
  ExportSettings settings;
  settings.format = format.format;
  settings.name = request.name;
  settings.grid = request.grid;
  settings.views.channel = request.channel;
  const MicroImages micro(camera, true, execution);
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
