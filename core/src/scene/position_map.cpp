#include "plenoflame/scene/scene_file.h"

namespace plenoflame {

void PositionMap::erase(std::string_view path) {
  const std::string prefix(path);
  std::erase_if(positions_, [&](const auto& entry) {
    const std::string& key = entry.first;
    return key == prefix || key.starts_with(prefix + ".") || key.starts_with(prefix + "[");
  });
}

SourcePosition PositionMap::find(std::string_view path) const {
  while (!path.empty()) {
    if (const auto it = positions_.find(path); it != positions_.end()) return it->second;
    // The table around "a.b[2]" is "a.b", and around that "a".
    const auto cut = path.find_last_of(".[");
    path = path.substr(0, cut == std::string_view::npos ? 0 : cut);
  }
  return {};
}

}  // namespace plenoflame
