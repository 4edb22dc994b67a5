#include "plenoflame/scene/presets.h"

#include <algorithm>

#include "plenoflame/base/error.h"
#include "scene/files/preset_table.h"
#include "scene/schema/nearest.h"

namespace plenoflame {

std::vector<std::string> preset_names(PresetKind kind) {
  std::vector<std::string> names;
  for (const PresetRow& row : preset_table())
    if (row.kind == kind) names.emplace_back(row.name);
  std::sort(names.begin(), names.end());
  return names;
}

std::string_view preset_text(PresetKind kind, std::string_view name) {
  for (const PresetRow& row : preset_table())
    if (row.kind == kind && row.name == name) return row.text;
  throw InputError(std::string("there is no ") +
                   (kind == PresetKind::camera ? "camera"
                    : kind == PresetKind::lens ? "lens"
                                               : "flame") +
                   " preset " + quote_for_message(name) + suggestion(name, preset_names(kind)));
}

std::string preset_description(PresetKind kind, std::string_view name) {
  std::string_view line = preset_text(kind, name);
  line = line.substr(0, line.find('\n'));
  const auto start = line.find_first_not_of("# ");
  return std::string(start == std::string_view::npos ? std::string_view() : line.substr(start));
}

}  // namespace plenoflame
