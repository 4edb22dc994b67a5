#include "plenoflame/scene/scene_settings.h"

#include <algorithm>
#include <utility>

#include "plenoflame/scene/scene_schema.h"
#include "scene/schema/nearest.h"
#include "scene/schema/scene_in_reading.h"
#include "scene/schema/schema_cameras.h"

namespace plenoflame {
namespace {

/// One step of a path: "flames[candle]" has the name "flames" and the item "candle".
struct Step {
  std::string name, item;
  bool has_item = false;
};

std::vector<Step> steps_of(std::string_view path) {
  std::vector<Step> steps(1);
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (path[i] == '[') {
      const std::size_t close = path.find(']', i);
      if (close == std::string_view::npos || steps.back().has_item)
        throw InputError("the brackets in " + quote_for_message(path) + " are not in pairs");
      steps.back().item = std::string(path.substr(i + 1, close - i - 1));
      steps.back().has_item = true;
      i = close;
    } else if (path[i] == '.') {
      steps.emplace_back();
    } else if (steps.back().has_item) {
      throw InputError("a dot is missing after the bracket in " + quote_for_message(path));
    } else {
      steps.back().name += path[i];
    }
  }
  return steps;
}

bool is_number(const std::string& text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
}

/// Number of the item of a list that has this name.
std::size_t item_named(const Scene& scene, const SchemaList& list,
                       const std::vector<std::size_t>& indices, const std::string& path,
                       const std::string& name) {
  const SchemaKey* key = find_schema_key(std::string(list.path) + "[].name");
  const std::size_t size = list.size(scene, indices);
  std::vector<std::string> names;
  std::size_t found = size;
  for (std::size_t i = 0; key && i < size; ++i) {
    std::vector<std::size_t> deeper = indices;
    deeper.push_back(i);
    names.push_back(std::get<std::string>(key->get(scene, deeper)));
    if (names.back() != name) continue;
    if (found < size)
      throw InputError("several items of " + path + " are named " + quote_for_message(name) +
                       "; give the number of one, " + path + "[" + std::to_string(found) + "]");
    found = i;
  }
  if (found < size) return found;
  if (size == 0) throw InputError(path + " has no items");
  std::erase(names, "");
  const std::string numbers =
      size == 1 ? path + "[0]" : path + "[0] to " + path + "[" + std::to_string(size - 1) + "]";
  throw InputError(path + " is a list, and none of its items is named " + quote_for_message(name) +
                   suggestion(name, names) + (names.empty() ? "; items are " : "; by number: ") +
                   numbers);
}

ScenePlace place_of(const Scene& scene, std::string_view text) {
  const std::vector<Step> steps = steps_of(text);
  ScenePlace place;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    for (std::string* path : {&place.path, &place.schema_path})
      path->append(i == 0 ? "" : ".").append(steps[i].name);
    const SchemaList* list = find_schema_list(place.schema_path);
    if (!list && steps[i].has_item)
      throw InputError(quote_for_message(place.path) + " is not a list, so it takes no brackets");
    if (!list || (!steps[i].has_item && i + 1 == steps.size())) continue;
    // Without brackets the next step names the item.
    const bool in_brackets = steps[i].has_item;
    const std::string item = in_brackets ? steps[i].item : steps[++i].name;
    if (!in_brackets && steps[i].has_item)
      throw InputError("the item " + quote_for_message(item) + " of " + place.path +
                       " is not a list, so it takes no brackets");
    const std::size_t number = is_number(item)
                                   ? static_cast<std::size_t>(std::stoull(item.substr(0, 18)))
                                   : item_named(scene, *list, place.indices, place.path, item);
    const std::size_t size = list->size(scene, place.indices);
    if (number >= size)
      throw InputError(place.path + " has " + std::to_string(size) +
                       (size == 1 ? " item" : " items") +
                       ", counted from 0, so there is no number " + item);
    place.indices.push_back(number);
    place.path.append("[").append(std::to_string(number)).append("]");
    place.schema_path += "[]";
  }
  return place;
}

/// Table around a path, "" for the whole scene, and what stands behind its last dot.
std::pair<std::string, std::string> split(const std::string& path) {
  const auto dot = path.rfind('.');
  if (dot == std::string::npos) return {"", path};
  return {path.substr(0, dot), path.substr(dot + 1)};
}

bool is_instruction(const std::string& table, const std::string& name) {
  const bool lens = table == "camera.lens" || table == "cameras[].lens";
  if (lens && (name == "file" || name == "f_number")) return true;
  if (table == schema::kEachCamera && name == "like") return true;
  if (name != "preset") return false;
  return std::any_of(schema_tables().begin(), schema_tables().end(),
                     [&](const SchemaTable& row) { return row.path == table && row.has_preset; });
}

/// "flames[].position" -> "flames[0].position".
std::string with_numbers(std::string_view path) {
  std::string text;
  for (const char c : path) {
    if (c == ']' && text.ends_with('[')) text += '0';
    text += c;
  }
  return text;
}

[[noreturn]] void unknown_key(std::string_view path, const std::string& schema_path) {
  const std::string name = split(schema_path).second;
  std::vector<std::string> paths{"camera.preset", "camera.lens.preset", "camera.lens.file",
                                 "camera.lens.f_number", "flames[].preset"};
  for (const SchemaKey& key : schema_keys()) paths.emplace_back(key.path);
  std::string same_end;  // the last name alone, as it stands in many files
  for (const std::string& known : paths)
    if (split(known).second == name && !known.starts_with(schema::kEachCamera))
      same_end.append(same_end.empty() ? "" : " or ").append(with_numbers(known));
  const std::string nearest =
      same_end.empty() ? with_numbers(nearest_word(schema_path, paths)) : same_end;
  throw InputError("there is no key " + quote_for_message(path) +
                   (nearest.empty() ? "; docs/reference/scene.md lists them"
                                    : "; did you mean " + nearest + "?"));
}

void set(SceneInReading& reading, std::string_view path, const std::string& value,
         const std::string& origin) {
  Scene& scene = reading.document.scene;
  const ScenePlace place = place_of(scene, path);
  const auto [table, name] = split(place.schema_path);
  if (schema::is_of_camera(place.schema_path) && !scene.cameras.empty())
    throw InputError("the scene has several cameras; say which: cameras." +
                     scene.cameras.front().name +
                     place.schema_path.substr(schema::kOneCamera.size()));
  // A file that has this table means that the array is there.
  const bool of_array = table.starts_with("camera.array") || table.starts_with("cameras[].array");
  if (of_array && name != "present") {
    const bool one = schema::is_of_camera(table);
    (one ? scene.camera : scene.cameras.at(place.indices.front())).array.present = true;
  }
  if (is_instruction(table, name)) {
    read_instruction(reading, {split(place.path).first, table, place.indices}, name, value, origin);
  } else if (const SchemaKey* key = find_schema_key(place.schema_path)) {
    const SchemaValue converted = value_from_text(*key, value);
    check_range(*key, converted);
    key->set(scene, place.indices, converted);
  } else if (find_schema_list(place.schema_path)) {
    throw InputError(place.path +
                     " is a list of tables, which has no value of its own; set a key "
                     "of an item, such as " +
                     place.path + "[0].name");
  } else {
    unknown_key(path, place.schema_path);
  }
  reading.document.positions.set(place.path, {origin, 0, 0});
  reading.set_paths.insert(place.path);
}

/// The path of "PATH=VALUE"; empty: there is none.
std::string path_of(const std::string& setting) {
  std::string path = setting.substr(0, std::min(setting.find('='), setting.size()));
  path.erase(path.find_last_not_of(" \t") + 1);
  path.erase(0, path.find_first_not_of(" \t"));
  return path;
}

void apply_setting(const std::string& setting, SceneInReading& reading) {
  const auto equals = setting.find('=');
  if (equals == std::string::npos || equals == 0)
    throw InputError(
        SourcePosition{reading.option},
        quote_for_message(setting) +
            " is not of the form KEY=VALUE, such as camera.focus.object_distance=0.9m");
  const std::string path = path_of(setting);
  const std::string origin = reading.option + " " + path;
  try {
    set(reading, path, setting.substr(equals + 1), origin);
  } catch (const InputError& error) {
    if (error.position().file.starts_with(origin)) throw;
    throw InputError(SourcePosition{origin}, error.what());
  }
}

/// Tells whether a setting is about a key of this camera. A setting with an
/// invalid path is about none; applying the settings reports it.
bool is_about_camera(const std::string& setting, const Scene& scene, std::size_t number) {
  try {
    const std::vector<Step> steps = steps_of(path_of(setting));
    if (steps.front().name != schema::kCameraList || steps.size() < 2) return false;
    const std::string item = steps.front().has_item ? steps.front().item : steps[1].name;
    return is_number(item) ? item == std::to_string(number)
                           : !item.empty() && item == scene.cameras.at(number).name;
  } catch (const InputError&) {
    return false;
  }
}

/// Applies some of the settings, and takes them off the list.
template <class Chosen>
void apply_chosen(SceneInReading& reading, const Chosen& chosen) {
  const bool closed = std::exchange(reading.closed, false);
  std::vector<std::string> left;
  for (const std::string& setting : std::exchange(reading.settings, {}))
    if (chosen(setting))
      apply_setting(setting, reading);
    else
      left.push_back(setting);
  reading.settings = std::move(left);
  reading.closed = closed;
}

}  // namespace

void apply_settings(SceneInReading& reading) {
  apply_chosen(reading, [](const std::string&) { return true; });
}

void apply_settings_of_camera(SceneInReading& reading, std::size_t number) {
  apply_chosen(reading, [&](const std::string& setting) {
    return is_about_camera(setting, reading.document.scene, number);
  });
}

SceneDocument parse_embedded_scene(std::string_view text, const std::string& file,
                                   SceneSettings settings) {
  settings.embedded = true;
  settings.embedded_in = file;
  return parse_scene(text, "scene of " + file, settings);
}

std::string resolve_path(const Scene& scene, std::string_view path) {
  return place_of(scene, path).path;
}

}  // namespace plenoflame
