#include <fmt/format.h>

#include <string>

#include "base/dimension_name.h"
#include "plenoflame/scene/scene_schema.h"
#include "scene/schema/schema_cameras.h"

namespace plenoflame {
namespace {

std::string code(std::string_view text) {
  return fmt::format("`{}`", text);
}

std::string type_text(const SchemaKey& key) {
  const std::string_view quantity = dimension_name(key.dimension);
  switch (key.type) {
    case ValueType::boolean:
      return "boolean";
    case ValueType::integer:
    case ValueType::natural:
      return "integer";
    case ValueType::number:
      return std::string(quantity);
    case ValueType::text:
      return "text";
    case ValueType::choice:
      return "word";
    case ValueType::vector2:
      return fmt::format("2 x {}", quantity);
    case ValueType::vector3:
      return fmt::format("3 x {}", quantity);
  }
  return "";
}

std::string default_text(const SchemaKey& key) {
  if (is_required(key)) return "required";
  const std::string text = value_to_text(key, default_value(key));
  return text.empty() ? "empty" : code(text);
}

std::string allowed_text(const SchemaKey& key) {
  if (key.type == ValueType::choice) {
    std::string text;
    for (const std::string_view word : key.choices)
      text.append(text.empty() ? "" : ", ").append(code(word));
    return text;
  }
  return range_text(key);
}

std::string header_of(std::string_view table) {
  const bool item = table.ends_with("[]");
  std::string name;
  for (const char c : table)
    if (c != '[' && c != ']') name += c;
  return item ? fmt::format("[[{}]]", name) : fmt::format("[{}]", name);
}

std::string units_text() {
  std::string text = "| quantity | units |\n|---|---|\n";
  for (const Dimension dimension :
       {Dimension::length, Dimension::temperature, Dimension::absorption, Dimension::angle,
        Dimension::flux, Dimension::radiance, Dimension::irradiance, Dimension::time,
        Dimension::frequency}) {
    std::string units;
    for (const std::string& unit : accepted_units(dimension))
      units.append(units.empty() ? "" : ", ").append(code(unit));
    text.append("| ").append(dimension_name(dimension)).append(" | ").append(units).append(" |\n");
  }
  return text;
}

void add_presets(std::string& page, PresetKind kind) {
  page += "| preset | what it is |\n|---|---|\n";
  for (const std::string& name : preset_names(kind))
    page.append("| ")
        .append(code(name))
        .append(" | ")
        .append(preset_description(kind, name))
        .append(" |\n");
}

}  // namespace

std::string scene_reference_markdown() {
  std::string page =
      "# Scene files\n"
      "\n"
      "<!-- Generated from the table in core/src/scene/schema/schema_table.cpp; edit that. -->\n"
      "\n"
      "A scene is a [TOML](https://toml.io) file. Quantities are text that carries its unit, such "
      "as `\"0.1 mm\"`,\n"
      "`\"1650 K\"` or `\"30 1/m\"`; one without a unit is an error. Pure numbers are written as "
      "TOML numbers. Vectors are\n"
      "arrays: `[\"1 m\", \"0 m\", \"-29 mm\"]`. An unknown key is an error. Relative file names "
      "start at the folder of the\n"
      "scene file.\n"
      "\n" +
      units_text() +
      "\n"
      "`inf` is a length: a radius of `\"inf\"` is a plane. The world is right-handed with z up. "
      "The camera's frame has\n"
      "its origin at the front vertex of the main lens. There z points towards the scene, x right "
      "and y down.\n"
      "\n"
      "## Presets\n"
      "\n"
      "`preset = \"NAME\"` in `[camera]`, `[camera.lens]` or `[[flames]]` starts from a preset "
      "([rules](../user/scenes.md#start-from-a-preset)). The texts are in the folder\n"
      "`core/presets`, with notes on values that their sources leave open.\n"
      "\n";
  add_presets(page, PresetKind::camera);
  page += "\n";
  add_presets(page, PresetKind::flame);
  page += "\n";
  add_presets(page, PresetKind::lens);
  for (const SchemaTable& table : schema_tables()) {
    if (table.path == schema::kEachCamera) {
      page +=
          "\n## `[[cameras]]`\n"
          "\n"
          "Several cameras in place of `[camera]`, each with its own `name` "
          "(docs/user/cameras.md). "
          "An item has all keys and tables\n"
          "of `[camera]`, as `[cameras.lens]`, `[[cameras.array.types]]` and so on below it. "
          "`like = \"NAME\"` starts from an earlier camera.\n"
          "\n"
          "A list of 1 to " +
          std::to_string(find_schema_list("cameras")->most) + " items.\n";
    }
    if (table.path.starts_with(schema::kEachCamera)) continue;
    page.append("\n## ")
        .append(code(header_of(table.path)))
        .append("\n\n")
        .append(table.description)
        .append("\n\n");
    if (table.path.ends_with("[]")) {
      const SchemaList* list = find_schema_list(table.path.substr(0, table.path.size() - 2));
      page.append("A list of ")
          .append(std::to_string(list->fewest))
          .append(" to ")
          .append(std::to_string(list->most))
          .append(" items.\n\n");
    }
    page += "| key | type | default | allowed | meaning |\n|---|---|---|---|---|\n";
    if (table.has_preset)
      page += "| `preset` | text | none | see above | Start from this preset. |\n";
    if (table.path == "camera.lens")
      page +=
          "| `file` | text | none | .toml, .zmx, .dat, .txt | Read the prescription from this "
          "file. |\n| `f_number` | number | none | above 0 | Focal length over the diameter of the "
          "entrance pupil: sets or narrows the stop. |\n";
    const std::string prefix = std::string(table.path) + ".";
    for (const SchemaKey& key : schema_keys()) {
      if (!key.path.starts_with(prefix)) continue;
      const std::string_view name = key.path.substr(prefix.size());
      if (name.find_first_of(".[") != std::string_view::npos) continue;
      page.append("| ")
          .append(code(name))
          .append(" | ")
          .append(type_text(key))
          .append(" | ")
          .append(default_text(key));
      page.append(" | ")
          .append(allowed_text(key))
          .append(" | ")
          .append(key.description)
          .append(" |\n");
    }
  }
  return page;
}

}  // namespace plenoflame
