#include "plenoflame/scene/scene_differences.h"

#include <fmt/format.h>

#include <map>
#include <sstream>
#include <utility>

#include "plenoflame/scene/scene_file.h"

namespace plenoflame {
namespace {

using Setting = std::pair<std::string, std::string>;

/// Paths and values of a scene as write_scene() puts it: one key a line, below its table's header.
std::vector<Setting> settings_of(const Scene& scene) {
  std::vector<Setting> settings;
  std::map<std::string, int> entries;     // of each list, so far
  std::map<std::string, std::string> at;  // the list's last entry with its index
  std::string table;
  std::istringstream lines(write_scene(scene));
  for (std::string line; std::getline(lines, line);) {
    if (line.empty()) continue;
    if (line.front() != '[') {
      const auto equals = line.find(" = ");
      settings.emplace_back((table.empty() ? "" : table + ".") + line.substr(0, equals),
                            line.substr(equals + 3));
      continue;
    }
    const bool list = line.starts_with("[[");
    const std::size_t bracket = list ? 2 : 1;
    std::istringstream names(line.substr(bracket, line.size() - 2 * bracket));
    std::string plain;
    table.clear();
    for (std::string name; std::getline(names, name, '.');) {
      plain += (plain.empty() ? "" : ".") + name;
      table += (table.empty() ? "" : ".") + name;
      // Lists within a list begin anew with each of its entries: counted by where they stand.
      if (list && names.eof()) at[plain] = fmt::format("[{}]", entries[table]++);
      if (const auto index = at.find(plain); index != at.end()) table += index->second;
    }
  }
  return settings;
}

}  // namespace

std::vector<SceneDifference> scene_differences(const Scene& before, const Scene& after) {
  const std::vector<Setting> old_ones = settings_of(before), new_ones = settings_of(after);
  const std::map<std::string, std::string> by_path(new_ones.begin(), new_ones.end());
  std::map<std::string, std::string> known(old_ones.begin(), old_ones.end());
  std::vector<SceneDifference> differences;
  for (const auto& [path, value] : old_ones) {
    const auto now = by_path.find(path);
    const std::string other = now == by_path.end() ? "" : now->second;
    if (other != value) differences.push_back({path, value, other});
  }
  for (const auto& [path, value] : new_ones)
    if (!known.contains(path)) differences.push_back({path, "", value});
  return differences;
}

}  // namespace plenoflame
