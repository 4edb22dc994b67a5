#include "plenoflame/scene/scene_file.h"

namespace plenoflame {

namespace {

bool is_at_or_below(const std::string& key, const std::string& path) {
  return key == path || key.starts_with(path + ".") || key.starts_with(path + "[");
}

}  // namespace

void PositionMap::erase(std::string_view path) {
  const std::string prefix(path);
  std::erase_if(positions_, [&](const auto& entry) { return is_at_or_below(entry.first, prefix); });
}

void PositionMap::copy(std::string_view from, std::string_view to) {
  const std::string prefix(from);
  std::map<std::string, SourcePosition, std::less<>> copied;
  for (const auto& [key, position] : positions_)
    if (is_at_or_below(key, prefix)) copied[std::string(to) + key.substr(prefix.size())] = position;
  erase(to);
  positions_.merge(copied);
}

void PositionMap::move(std::string_view from, std::string_view to) {
  copy(from, to);
  erase(from);
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
