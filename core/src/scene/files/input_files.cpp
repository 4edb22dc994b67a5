#include "plenoflame/scene/input_files.h"

#include <filesystem>

namespace plenoflame {

InputFile input_file(const std::string& name, const std::string& folder) {
  const std::filesystem::path path = std::filesystem::path(folder) / name;
  InputFile file{name};
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  if (error) return file;
  file.size = size;
  file.modified = std::filesystem::last_write_time(path, error).time_since_epoch().count();
  return file;
}

std::vector<InputFile> input_files(const Scene& scene) {
  const std::string folder = std::filesystem::path(scene.file).parent_path().string();
  std::vector<InputFile> files;
  const auto add = [&](const std::string& name) {
    if (!name.empty()) files.push_back(input_file(name, folder));
  };
  for (const FlameSpec& flame : scene.flames) {
    add(flame.file);
    add(flame.time.table);
  }
  for (const SolidSurfaceSpec& surface : scene.surfaces) {
    add(surface.file);
    add(surface.material.texture.file);
  }
  for (const ChannelSpec& channel : scene.channels) add(channel.file);
  return files;
}

}  // namespace plenoflame
