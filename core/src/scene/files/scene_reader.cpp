#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <locale>
#include <sstream>

#include "plenoflame/image/text_file.h"
#include "plenoflame/optics/f_number.h"
#include "plenoflame/scene/glass_indices.h"
#include "plenoflame/scene/lens_file.h"
#include "plenoflame/scene/presets.h"
#include "plenoflame/scene/scene_file.h"
#include "plenoflame/scene/scene_schema.h"
#include "plenoflame/scene/scene_settings.h"
#include "scene/files/parse_toml.h"
#include "scene/files/toml_guard.h"
#include "scene/schema/nearest.h"
#include "scene/schema/scene_in_reading.h"
#include "scene/schema/schema_cameras.h"

namespace plenoflame {
namespace {

constexpr int kDeepestPreset = 4;  // presets may start from another preset

std::string type_name(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      return "an array";
    case toml::node_type::string:
      return "text";
    case toml::node_type::integer:
      return "a whole number";
    case toml::node_type::floating_point:
      return "a number";
    case toml::node_type::boolean:
      return "true or false";
    default:
      return "a date or time";
  }
}

std::string expected_type(const SchemaKey& key) {
  const std::string unit = key.dimension == Dimension::none ? "a number"
                           : key.dimension == Dimension::length
                               ? "text such as \"0.1 mm\""
                               : "text such as \"1 " + std::string(si_unit(key.dimension)) + "\"";
  switch (key.type) {
    case ValueType::boolean:
      return "true or false";
    case ValueType::integer:
    case ValueType::natural:
      return "a whole number";
    case ValueType::number:
      return unit;
    case ValueType::text:
      return "text";
    case ValueType::choice:
      return "one of the words " + range_text(key);
    case ValueType::vector2:
      return "an array of two, each " + unit;
    case ValueType::vector3:
      return "an array of three, each " + unit;
  }
  return "";
}

/// A table of one of several cameras as it is called of a single one: "cameras[].lens" ->
/// "camera.lens".
std::string as_of_one_camera(const std::string& table) {
  if (!table.starts_with(schema::kEachCamera)) return table;
  return std::string(schema::kOneCamera) + table.substr(schema::kEachCamera.size());
}

/// In the table camera.lens, beside keys of the schema: read, but not kept as they stand.
constexpr SchemaKey kFNumber{"camera.lens.f_number",
                             ValueType::number,
                             Dimension::none,
                             {0, 1e6, true, false},
                             {},
                             "",
                             nullptr,
                             nullptr};

/// Puts the values of a parsed file into a scene.
class Reader {
 public:
  Reader(SceneInReading& reading, std::string file, int depth)
      : reading_(reading),
        scene_(reading.document.scene),
        positions_(reading.document.positions),
        file_(std::move(file)),
        depth_(depth) {}

  /// @param table its schema path, "" for the whole file; @param path the same with indices
  void read_table(const toml::table& toml, const std::string& table, const std::string& path,
                  const std::vector<std::size_t>& indices) {
    const std::string what = as_of_one_camera(table);
    if (what == "camera.array" && !toml.contains("present"))
      camera_of(indices).array.present = true;
    if (takes_like(table)) read_like(toml, path, indices);
    read_preset(toml, table, path, indices);
    if (what == "camera.lens") read_lens(toml, path, camera_of(indices));
    for (const auto& [name, node] : in_file_order(toml)) {
      const std::string key_name(name->str());
      if (key_name == "preset" && takes_preset(table)) continue;
      if (key_name == "like" && takes_like(table)) continue;
      if (key_name == "file" && what == "camera.lens") continue;
      if (key_name == "f_number" && what == "camera.lens") {
        read_f_number(*node, path, indices);
        continue;
      }
      const std::string below = table.empty() ? key_name : table + "." + key_name;
      const std::string here = path.empty() ? key_name : path + "." + key_name;
      // "a.b" in quotes or with brackets is one odd name, never a path.
      const bool plain = key_name.find_first_of(".[]") == std::string::npos;
      if (const SchemaKey* key = plain ? find_schema_key(below) : nullptr) {
        read_value(*key, *node, here, indices);
      } else if (const SchemaList* list = plain ? find_schema_list(below) : nullptr) {
        read_list(*list, *node, here, indices);
      } else if (plain && is_table(below)) {
        if (!node->is_table())
          fail(*node, here + " is " + type_name(*node) +
                          ", but it must be a table of keys: write [" + below + "]");
        positions_.set(here, position(*node));
        read_table(*node->as_table(), below, here, indices);
      } else {
        throw InputError(position(name->source()), "unknown key " + quote_for_message(key_name) +
                                                       (table.empty() ? "" : " in " + path) +
                                                       suggestion(key_name, known_names(table)));
      }
    }
  }

  SourcePosition position(const toml::source_region& source) const {
    return {file_, static_cast<int>(source.begin.line), static_cast<int>(source.begin.column)};
  }

 private:
  /// The camera that a table of one is about. @param indices of that table
  CameraSpec& camera_of(const std::vector<std::size_t>& indices) {
    return indices.empty() ? scene_.camera : scene_.cameras.at(indices.front());
  }

  using Entry = std::pair<const toml::key*, const toml::node*>;

  SourcePosition position(const toml::node& node) const { return position(node.source()); }

  [[noreturn]] void fail(const toml::node& node, const std::string& message) const {
    throw InputError(position(node), message);
  }

  /// So that the first mistake of the file is the one reported.
  static std::vector<Entry> in_file_order(const toml::table& toml) {
    std::vector<Entry> entries;
    for (const auto& [key, node] : toml) entries.emplace_back(&key, &node);
    std::stable_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
      const auto& p = a.first->source().begin;
      const auto& q = b.first->source().begin;
      return p.line != q.line ? p.line < q.line : p.column < q.column;
    });
    return entries;
  }

  static bool takes_preset(std::string_view table) {
    for (const SchemaTable& row : schema_tables())
      if (row.path == table) return row.has_preset;
    return false;
  }

  /// One of several cameras may start from another.
  static bool takes_like(std::string_view table) { return table == schema::kEachCamera; }

  static bool is_table(std::string_view path) {
    for (const SchemaTable& row : schema_tables())
      if (row.path == path) return true;
    return false;
  }

  /// Names that may stand in a table: keys, lists and tables directly below it.
  static std::vector<std::string> known_names(const std::string& table) {
    std::vector<std::string> names;
    const std::string prefix = table.empty() ? "" : table + ".";
    const auto add = [&](std::string_view path) {
      if (!path.starts_with(prefix)) return;
      const std::string_view rest = path.substr(prefix.size());
      const std::string name(rest.substr(0, rest.find_first_of(".[")));
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    };
    if (takes_preset(table)) names.emplace_back("preset");
    if (takes_like(table)) names.emplace_back("like");
    if (as_of_one_camera(table) == "camera.lens") names.insert(names.end(), {"file", "f_number"});
    for (const SchemaKey& key : schema_keys()) add(key.path);
    return names;
  }

  void read_preset(const toml::table& toml, const std::string& table, const std::string& path,
                   const std::vector<std::size_t>& indices) {
    const toml::node* node = toml.get("preset");
    if (!node || !takes_preset(table)) return;
    const auto name = node->value<std::string>();
    if (!node->is_string() || !name)
      fail(*node, path + ".preset is " + type_name(*node) + ", but it must be text");
    if (depth_ >= kDeepestPreset) fail(*node, "presets start from each other in a loop");
    const std::string what = as_of_one_camera(table);
    const PresetKind kind = what == "camera"        ? PresetKind::camera
                            : what == "camera.lens" ? PresetKind::lens
                                                    : PresetKind::flame;
    std::string_view text;
    try {
      text = preset_text(kind, *name);
    } catch (const InputError& error) {
      fail(*node, error.what());
    }
    const std::string origin = "preset " + *name;
    const toml::table parsed = toml::parse(text, origin);
    if (kind != PresetKind::flame)  // that of another lens
      reading_.f_numbers.erase(kind == PresetKind::lens ? path : path + ".lens");
    Reader inner(reading_, origin, depth_ + 1);
    const toml::table* fragment = kind == PresetKind::camera ? parsed["camera"].as_table()
                                  : kind == PresetKind::lens ? parsed["camera"]["lens"].as_table()
                                                             : parsed["flames"][0].as_table();
    if (fragment) inner.read_table(*fragment, table, path, indices);
  }

  /// A camera that starts from an earlier one of the list.
  void read_like(const toml::table& toml, const std::string& path,
                 const std::vector<std::size_t>& indices) {
    const toml::node* node = toml.get("like");
    if (!node) return;
    const auto name = node->value<std::string>();
    if (!node->is_string() || !name)
      fail(*node, path + ".like is " + type_name(*node) + ", but it must be text");
    if (toml.contains("preset")) fail(*node, path + " has both a preset and like; leave one out");
    std::vector<std::string> earlier;
    for (std::size_t i = 0; i < indices.front(); ++i) earlier.push_back(scene_.cameras[i].name);
    const auto found = std::find(earlier.begin(), earlier.end(), *name);
    if (found == earlier.end() || name->empty())
      fail(*node, path + ".like: there is no camera " + quote_for_message(*name) + " before it" +
                      suggestion(*name, earlier));
    const auto other = static_cast<std::size_t>(found - earlier.begin());
    const SourcePosition item = positions_.find(path);
    CameraSpec& camera = camera_of(indices);
    camera = scene_.cameras[other];
    camera.name.clear();
    const std::string other_path = "cameras[" + std::to_string(other) + "]";
    reading_.f_numbers.erase(path + ".lens");
    if (const auto given = reading_.f_numbers.find(other_path + ".lens");
        given != reading_.f_numbers.end())
      reading_.f_numbers[path + ".lens"] = {given->second.value, indices.front()};
    positions_.copy(other_path, path);
    positions_.erase(path + ".name");
    positions_.set(path, item);
  }

  /// A prescription in a file of its own, in place of what came before.
  void read_lens(const toml::table& toml, const std::string& path, CameraSpec& camera) {
    const toml::node* node = toml.get("file");
    if (!node) return;
    const auto name = node->value<std::string>();
    if (!node->is_string() || !name || name->empty())
      fail(*node, path + ".file is " + type_name(*node) + ", but it must be the name of a file");
    if (toml.contains("preset")) fail(*node, path + " has both a preset and a file; leave one out");
    if (reading_.closed)
      fail(*node, path + ".file: a scene inside of another file opens no files; set " + path +
                      ".file=" + *name + " anew");
    const auto slash = scene_.file.rfind('/');
    const std::string folder = name->starts_with('/') || slash == std::string::npos
                                   ? ""
                                   : scene_.file.substr(0, slash + 1);
    reading_.f_numbers.erase(path);
    camera.lens = read_lens_file(folder + *name).lens;
    positions_.erase(path);
    positions_.set(path, position(*node));
  }

  /// @param path of the lens
  void read_f_number(const toml::node& node, const std::string& path,
                     const std::vector<std::size_t>& indices) {
    try {
      const double value = number(kFNumber, node);
      check_range(kFNumber, value);
      reading_.f_numbers[path] = {value,
                                  indices.empty() ? std::nullopt : std::optional(indices.front())};
      positions_.set(path + ".f_number", position(node));
    } catch (const InputError& error) {
      fail(node, path + ".f_number: " + error.what());
    }
  }

  void read_list(const SchemaList& list, const toml::node& node, const std::string& path,
                 const std::vector<std::size_t>& indices) {
    const toml::array* items = node.as_array();
    const std::string name(path.substr(path.rfind('.') + 1));
    if (!items)
      fail(node, path + " is " + type_name(node) + ", but it must be a list of tables: write [[" +
                     strip(path) + "]]");
    if (items->size() < list.fewest || items->size() > list.most)
      fail(node, path + " has " + std::to_string(items->size()) + " items, but " +
                     std::to_string(list.fewest) + " to " + std::to_string(list.most) +
                     " are allowed");
    // A list replaces the one that a preset or the defaults gave.
    list.resize(scene_, indices, 0);
    list.resize(scene_, indices, items->size());
    positions_.erase(path);
    positions_.set(path, position(node));
    for (std::size_t i = 0; i < items->size(); ++i) {
      const toml::node& item = *items->get(i);
      const std::string here = path + "[" + std::to_string(i) + "]";
      if (!item.is_table())
        fail(item, here + " is " + type_name(item) + ", but it must be a table");
      positions_.set(here, position(item));
      std::vector<std::size_t> deeper = indices;
      deeper.push_back(i);
      read_table(*item.as_table(), std::string(list.path) + "[]", here, deeper);
      if (list.path == schema::kCameraList) apply_settings_of_camera(reading_, i);
    }
  }

  /// "flames[2].layers" as it is written in TOML: "flames.layers".
  static std::string strip(const std::string& path) {
    std::string text;
    bool inside = false;
    for (const char c : path) {
      if (c == '[') inside = true;
      if (!inside) text += c;
      if (c == ']') inside = false;
    }
    return text;
  }

  void read_value(const SchemaKey& key, const toml::node& node, const std::string& path,
                  const std::vector<std::size_t>& indices) {
    const toml::node* at = &node;
    try {
      const SchemaValue value = convert(key, node, at);
      check_range(key, value);
      key.set(scene_, indices, value);
      positions_.set(path, position(node));
      if (key.path == "windows[].index") reading_.indices_of_windows.insert(path);
    } catch (const InputError& error) {
      fail(*at, path + ": " + error.what());
    }
  }

  [[noreturn]] static void wrong_type(const SchemaKey& key, const toml::node& node) {
    throw InputError("this is " + type_name(node) + ", but " + expected_type(key) + " is expected");
  }

  /// @param at is set to the node that a message should point at
  static SchemaValue convert(const SchemaKey& key, const toml::node& node, const toml::node*& at) {
    switch (key.type) {
      case ValueType::boolean:
        if (const auto* value = node.as_boolean()) return value->get();
        break;
      case ValueType::integer:
        if (const auto* value = node.as_integer()) return value->get();
        break;
      case ValueType::natural:
        if (const auto* value = node.as_integer()) {
          if (value->get() < 0)
            throw InputError("a negative number is not possible here; " + range_text(key) +
                             " is allowed");
          return static_cast<std::uint64_t>(value->get());
        }
        if (const auto* value = node.as_string()) return value_from_text(key, value->get());
        break;
      case ValueType::text:
      case ValueType::choice:
        if (const auto* value = node.as_string()) return value_from_text(key, value->get());
        break;
      case ValueType::number:
        return number(key, node);
      case ValueType::vector2:
      case ValueType::vector3: {
        const std::size_t count = key.type == ValueType::vector2 ? 2 : 3;
        const toml::array* array = node.as_array();
        if (!array) break;
        if (array->size() != count)
          throw InputError("this has " + std::to_string(array->size()) + " components, but " +
                           std::to_string(count) + " are expected");
        double c[3] = {};
        for (std::size_t i = 0; i < count; ++i) {
          at = array->get(i);
          c[i] = number(key, *at);
        }
        at = &node;
        if (count == 2) return Vec2{c[0], c[1]};
        return Vec3{c[0], c[1], c[2]};
      }
    }
    wrong_type(key, node);
  }

  static double number(const SchemaKey& key, const toml::node& node) {
    if (const auto* text = node.as_string()) return parse_quantity(text->get(), key.dimension);
    double value = 0;
    if (const auto* integer = node.as_integer()) {
      value = static_cast<double>(integer->get());
    } else if (const auto* floating = node.as_floating_point()) {
      value = floating->get();
    } else {
      wrong_type(key, node);
    }
    if (std::isnan(value)) throw InputError("nan is not a number");
    const bool infinite_length = std::isinf(value) && key.dimension == Dimension::length;
    if (key.dimension == Dimension::none && std::isinf(value))
      throw InputError("an infinite number is not possible here");
    if (key.dimension != Dimension::none && !infinite_length) {
      std::string units;
      for (const std::string& unit : accepted_units(key.dimension))
        units.append(units.empty() ? "" : ", ").append(unit);
      std::ostringstream written;
      written.imbue(std::locale::classic());
      written << value;
      throw InputError(
          "a unit is missing: write it in quotes with one of " + units + ", for example \"" +
          written.str() + " " +
          (key.dimension == Dimension::length ? "mm" : std::string(si_unit(key.dimension))) + "\"");
    }
    return value;
  }

  SceneInReading& reading_;
  Scene& scene_;
  PositionMap& positions_;
  std::string file_;
  int depth_;
};

void check_one_way_to_give_cameras(const toml::table& parsed, const std::string& name) {
  const toml::node *one = parsed.get("camera"), *several = parsed.get("cameras");
  if (!one || !several) return;
  const toml::source_region& second =
      one->source().begin.line > several->source().begin.line ? one->source() : several->source();
  throw InputError(
      {name, static_cast<int>(second.begin.line), static_cast<int>(second.begin.column)},
      "the scene has both [camera] and [[cameras]]; make the one camera an item of [[cameras]] "
      "with a name");
}

/// Refuses windows with an index beside a glass that has another. (That of the glass itself stands
/// in scenes that were written before it was left out.)
/// @param given the paths of the indices that count
void check_indices_of_windows(const SceneDocument& document, const std::set<std::string>& given) {
  const Scene& scene = document.scene;
  std::vector<WindowSpec> windows = scene.windows;
  set_indices(windows, design_wavelength(scene), document.positions);
  for (std::size_t i = 0; i < windows.size(); ++i) {
    const std::string path = "windows[" + std::to_string(i) + "]";
    if (scene.windows[i].index == windows[i].index || !given.contains(path + ".index")) continue;
    throw InputError(
        document.positions.find(path + ".index"),
        fmt::format("{}.index is {:.5g}, but the glass of the window, {}, has an index of {:.5g}; "
                    "leave one of them out",
                    path, scene.windows[i].index, quote_for_message(windows[i].glass),
                    windows[i].index));
  }
}

/// Without an array the sensor is what the object is conjugate to.
void focus_on_sensor(CameraSpec& camera, toml::node_view<const toml::node> toml,
                     const std::string& path, const SceneInReading& reading) {
  if (!camera.array.present && !toml["focus"]["conjugate"] &&
      !reading.set_paths.contains(path + ".focus.conjugate"))
    camera.focus.conjugate = "sensor";
}

}  // namespace

void read_instruction(SceneInReading& reading, const ScenePlace& table, const std::string& name,
                      const std::string& value, const std::string& origin) {
  toml::table fragment;
  fragment.insert(name, value);
  Reader(reading, origin, 0).read_table(fragment, table.schema_path, table.path, table.indices);
}

SceneDocument parse_scene(std::string_view text, const std::string& name) {
  return parse_scene(text, name, SceneSettings{});
}

SceneDocument parse_scene(std::string_view text, const std::string& name,
                          const SceneSettings& settings) {
  SceneInReading reading;
  reading.closed = settings.embedded;
  reading.settings = settings.values;
  reading.option = settings.option;
  reading.document.scene.file = settings.embedded ? settings.embedded_in : name;
  const toml::table parsed = parse_toml(text, name);
  check_one_way_to_give_cameras(parsed, name);
  Reader(reading, name, 0).read_table(parsed, "", "", {});
  if (!settings.embedded) check_indices_of_windows(reading.document, reading.indices_of_windows);
  apply_settings(reading);
  Scene& scene = reading.document.scene;
  const PositionMap& positions = reading.document.positions;
  if (scene.cameras.empty()) focus_on_sensor(scene.camera, parsed["camera"], "camera", reading);
  for (std::size_t i = 0; i < scene.cameras.size(); ++i)
    focus_on_sensor(scene.cameras[i], parsed["cameras"][i], "cameras[" + std::to_string(i) + "]",
                    reading);
  // A glass that is set takes the place of the file's index, but not of one that is set as well.
  check_indices_of_windows(reading.document, reading.set_paths);
  set_indices(scene, reading.document.positions);
  for (const auto& [lens, given] : reading.f_numbers) {
    CameraSpec& camera = given.camera ? scene.cameras.at(*given.camera) : scene.camera;
    try {
      set_f_number(camera.lens, given.value);
    } catch (const InputError& error) {
      throw InputError(positions.find(lens + ".f_number"),
                       lens + ".f_number: " + std::string(error.what()));
    }
  }
  return std::move(reading.document);
}

std::vector<EllipsoidSpec> parse_layers(std::string_view text, const std::string& name) {
  const toml::table parsed = parse_toml(text, name);
  SceneInReading reading;
  Scene& scene = reading.document.scene;
  scene.flames.resize(1);
  const PositionMap& positions = reading.document.positions;
  Reader reader(reading, name, 0);
  for (const auto& [key, node] : parsed)
    if (key.str() != "layers")
      throw InputError(reader.position(key.source()),
                       "unknown key " + quote_for_message(key.str()) +
                           "; a file of layers holds [[layers]] tables only");
  reader.read_table(parsed, "flames[]", "", {0});
  const std::vector<EllipsoidSpec>& layers = scene.flames[0].layers;
  if (layers.empty()) throw InputError(SourcePosition{name}, "there are no [[layers]] tables");
  for (std::size_t i = 0; i < layers.size(); ++i)
    for (const SchemaKey& key : schema_keys()) {
      if (!key.path.starts_with("flames[].layers[].") ||
          in_range(key, key.get(scene, std::array{std::size_t{0}, i})))
        continue;
      const std::string path = "layers[" + std::to_string(i) + "]";
      throw InputError(positions.find(path), path +
                                                 std::string(key.path.substr(key.path.rfind('.'))) +
                                                 " is missing; " + range_text(key) + " is allowed");
    }
  return layers;
}

SceneDocument read_scene_file(const std::string& path) {
  return read_scene_file(path, SceneSettings{});
}

SceneDocument read_scene_file(const std::string& path, const SceneSettings& settings) {
  return parse_scene(read_text_file(path), path, settings);
}

}  // namespace plenoflame
