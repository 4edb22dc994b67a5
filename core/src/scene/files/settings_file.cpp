#include "plenoflame/scene/settings_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "plenoflame/image/text_file.h"
#include "scene/files/parse_toml.h"

namespace plenoflame {
namespace {

/// @throws InputError at the value
std::string text_of(const toml::node& node, const std::string& path) {
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* whole = node.as_integer()) return fmt::format("{}", whole->get());
  if (const auto* number = node.as_floating_point()) return fmt::format("{}", number->get());
  if (const auto* flag = node.as_boolean()) return flag->get() ? "true" : "false";
  std::string list;
  if (const auto* items = node.as_array()) {
    for (const toml::node& item : *items) list += (list.empty() ? "" : ",") + text_of(item, path);
    return list;
  }
  const auto& [line, column] = node.source().begin;
  throw InputError({path, static_cast<int>(line), static_cast<int>(column)},
                   "a setting is a text, a number, true, false, or a list of these");
}

SourcePosition position_of(const toml::key& key, const std::string& path) {
  const auto& [line, column] = key.source().begin;
  return {path, static_cast<int>(line), static_cast<int>(column)};
}

}  // namespace

std::optional<std::vector<FileSetting>> read_settings(const std::string& path,
                                                      const std::string& table) {
  const toml::table root = parse_toml(read_text_file(path), path);
  const toml::table* found = root[table].as_table();
  for (const auto& [key, node] : root)
    if (found == nullptr && key.str() == table)
      throw InputError(position_of(key, path),
                       fmt::format(R"("{0}" is not a table; begin it with [{0}])", table));
  if (found == nullptr) return std::nullopt;
  for (const auto& [key, node] : root)
    if (&node != found)
      throw InputError(
          position_of(key, path),
          fmt::format(R"("{}" stands beside [{}], which is alone in its file)", key.str(), table));
  std::vector<FileSetting> settings;
  for (const auto& [key, node] : *found) {
    FileSetting& setting =
        settings.emplace_back(FileSetting{std::string(key.str()), {}, position_of(key, path)});
    if (const auto* items = node.as_array())
      for (const toml::node& item : *items) setting.values.push_back(text_of(item, path));
    else
      setting.values.push_back(text_of(node, path));
  }
  std::ranges::sort(settings, {}, [](const FileSetting& setting) {
    return std::tuple(setting.position.line, setting.position.column);
  });
  return settings;
}

}  // namespace plenoflame
