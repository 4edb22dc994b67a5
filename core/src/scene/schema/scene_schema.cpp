#include "plenoflame/scene/scene_schema.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <concepts>

#include "plenoflame/base/error.h"
#include "plenoflame/scene/cameras.h"
#include "scene/schema/nearest.h"
#include "scene/schema/schema_cameras.h"

namespace plenoflame {
namespace {

constexpr int kMessageDigits = 6;  // of a value that is refused: enough to recognise it

std::string_view trim(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

template <class Row>
const Row* find_row(std::span<const Row> rows, std::string_view path) {
  const std::string schema_path = parse_path(path).schema_path;
  for (const Row& row : rows)
    if (row.path == schema_path) return &row;
  return nullptr;
}

std::size_t bracket_count(std::string_view schema_path) {
  return static_cast<std::size_t>(std::count(schema_path.begin(), schema_path.end(), '['));
}

/// @throws InputError unless the indices name items that exist.
void check_indices(const Scene& scene, std::string_view path, const ParsedPath& parsed) {
  if (parsed.indices.size() != bracket_count(parsed.schema_path))
    throw InputError("the path " + quote_for_message(path) +
                     " needs a number in each pair of brackets");
  std::size_t level = 0;
  for (auto at = parsed.schema_path.find("[]"); at != std::string::npos;
       at = parsed.schema_path.find("[]", at + 2), ++level) {
    const std::string list_path = parsed.schema_path.substr(0, at);
    const SchemaList* list = find_schema_list(list_path);
    if (!list) throw InputError("there is no list " + quote_for_message(list_path));
    const std::size_t size = list->size(scene, SchemaIndices(parsed.indices).first(level));
    if (parsed.indices[level] >= size)
      throw InputError("the path " + quote_for_message(path) + " asks for item " +
                       std::to_string(parsed.indices[level]) + " of " + list_path + ", which has " +
                       std::to_string(size));
  }
}

const SchemaKey& key_at(const Scene& scene, std::string_view path, const ParsedPath& parsed) {
  const SchemaKey* key = find_schema_key(parsed.schema_path);
  if (!key) {
    std::vector<std::string> known;
    for (const SchemaKey& row : schema_keys()) known.emplace_back(row.path);
    const std::string nearest = nearest_word(parsed.schema_path, known);
    throw InputError("there is no key " + quote_for_message(path) +
                     (nearest.empty() ? "" : "; did you mean \"" + nearest + "\"?"));
  }
  if (!scene.cameras.empty() && schema::is_of_camera(parsed.schema_path))
    throw InputError("the scene has several cameras; write \"cameras[0]" +
                     std::string(path.substr(schema::kOneCamera.size())) + "\" for " +
                     camera_in_words(scene.cameras.front()));
  check_indices(scene, path, parsed);
  return *key;
}

const SchemaList& list_at(const Scene& scene, std::string_view path, const ParsedPath& parsed) {
  const SchemaList* list = find_schema_list(parsed.schema_path);
  if (!list) throw InputError("there is no list " + quote_for_message(path));
  check_indices(scene, path, parsed);
  return *list;
}

template <std::integral T>
T integer_from_text(const SchemaKey& key, std::string_view text) {
  const std::string_view trimmed = trim(text);
  T value{};
  const auto [end, error] = std::from_chars(trimmed.data(), trimmed.data() + trimmed.size(), value);
  if (error != std::errc() || end != trimmed.data() + trimmed.size())
    throw InputError(quote_for_message(text) + " is not a whole number; " + range_text(key) +
                     " is allowed");
  return value;
}

std::vector<double> components_from_text(const SchemaKey& key, std::string_view text,
                                         std::size_t count) {
  std::vector<double> components;
  std::string_view rest = text;
  for (;;) {
    const auto comma = rest.find(',');
    components.push_back(parse_quantity(rest.substr(0, comma), key.dimension));
    if (comma == std::string_view::npos || components.size() > count) break;
    rest.remove_prefix(comma + 1);
  }
  if (components.size() != count)
    throw InputError(quote_for_message(text) + " does not have " + std::to_string(count) +
                     " components, separated by commas");
  return components;
}

/// The numbers in a value that a range applies to.
std::vector<double> components(const SchemaValue& value) {
  if (const auto* number = std::get_if<double>(&value)) return {*number};
  if (const auto* integer = std::get_if<std::int64_t>(&value))
    return {static_cast<double>(*integer)};
  if (const auto* v = std::get_if<Vec2>(&value)) return {v->x, v->y};
  if (const auto* v = std::get_if<Vec3>(&value)) return {v->x, v->y, v->z};
  return {};
}

bool in_range(double value, const ValueRange& range) {
  return value >= range.lower && value <= range.upper &&
         !(range.above_lower && value == range.lower) && !(range.nonzero && value == 0);
}

/// Appends every path below a table ("" is the whole scene) in the order of the schema.
void add_paths(const Scene& scene, std::string_view table, std::string concrete,
               const std::vector<std::size_t>& indices, std::vector<std::string>& paths) {
  const std::string prefix = table.empty() ? "" : std::string(table) + ".";
  std::vector<std::string> seen;
  for (const SchemaKey& key : schema_keys()) {
    if (!key.path.starts_with(prefix)) continue;
    if (!scene.cameras.empty() && key.path.starts_with("camera.")) continue;  // there is none
    const std::string_view rest = key.path.substr(prefix.size());
    const auto bracket = rest.find("[]");
    const std::string dot = concrete.empty() ? "" : concrete + ".";
    if (bracket == std::string_view::npos) {
      paths.push_back(dot + std::string(rest));
      continue;
    }
    const std::string name(rest.substr(0, bracket));
    if (std::find(seen.begin(), seen.end(), name) != seen.end()) continue;
    seen.push_back(name);
    const SchemaList* list = find_schema_list(prefix + name);
    const std::size_t size = list->size(scene, indices);
    for (std::size_t i = 0; i < size; ++i) {
      std::vector<std::size_t> deeper = indices;
      deeper.push_back(i);
      add_paths(scene, prefix + name + "[]", dot + name + "[" + std::to_string(i) + "]", deeper,
                paths);
    }
  }
}

}  // namespace

ParsedPath parse_path(std::string_view path) {
  ParsedPath parsed;
  std::size_t i = 0;
  while (i < path.size()) {
    if (path[i] != '[') {
      parsed.schema_path += path[i++];
      continue;
    }
    const auto close = path.find(']', i);
    const std::string_view digits =
        close == std::string_view::npos ? std::string_view("?") : path.substr(i + 1, close - i - 1);
    if (!digits.empty()) {
      std::size_t index = 0;
      const auto [end, error] =
          std::from_chars(digits.data(), digits.data() + digits.size(), index);
      if (error != std::errc() || end != digits.data() + digits.size())
        throw InputError("the path " + quote_for_message(path) + " has brackets without a number");
      parsed.indices.push_back(index);
    }
    parsed.schema_path += "[]";
    i = close + 1;
  }
  return parsed;
}

const SchemaKey* find_schema_key(std::string_view path) {
  return find_row(schema_keys(), path);
}
const SchemaList* find_schema_list(std::string_view path) {
  return find_row(schema_lists(), path);
}

std::vector<std::string> scene_paths(const Scene& scene) {
  std::vector<std::string> paths;
  add_paths(scene, "", "", {}, paths);
  return paths;
}

std::string get_text(const Scene& scene, std::string_view path) {
  const ParsedPath parsed = parse_path(path);
  const SchemaKey& key = key_at(scene, path, parsed);
  return value_to_text(key, key.get(scene, parsed.indices));
}

void set_text(Scene& scene, std::string_view path, std::string_view text) {
  const ParsedPath parsed = parse_path(path);
  const SchemaKey& key = key_at(scene, path, parsed);
  const SchemaValue value = value_from_text(key, text);
  check_range(key, value);
  key.set(scene, parsed.indices, value);
}

std::size_t list_size(const Scene& scene, std::string_view path) {
  const ParsedPath parsed = parse_path(path);
  return list_at(scene, path, parsed).size(scene, parsed.indices);
}

void insert_item(Scene& scene, std::string_view path, std::size_t position) {
  const ParsedPath parsed = parse_path(path);
  const SchemaList& list = list_at(scene, path, parsed);
  const std::size_t size = list.size(scene, parsed.indices);
  if (position > size)
    throw InputError(std::string(path) + " has only " + std::to_string(size) + " items");
  if (size >= list.most)
    throw InputError(std::string(path) + " takes at most " + std::to_string(list.most) + " items");
  if (list.path == "cameras") return insert_camera(scene, position);
  list.insert(scene, parsed.indices, position);
}

void erase_item(Scene& scene, std::string_view path, std::size_t position) {
  const ParsedPath parsed = parse_path(path);
  const SchemaList& list = list_at(scene, path, parsed);
  const std::size_t size = list.size(scene, parsed.indices);
  if (position >= size)
    throw InputError(std::string(path) + " has only " + std::to_string(size) + " items");
  const std::size_t fewest = list.path == "cameras" ? 1 : list.fewest;  // once there are any
  if (size <= fewest)
    throw InputError(std::string(path) + " needs at least " + std::to_string(fewest) + " items");
  list.erase(scene, parsed.indices, position);
}

std::string value_to_text(const SchemaKey& key, const SchemaValue& value) {
  switch (key.type) {
    case ValueType::boolean:
      return std::get<bool>(value) ? "true" : "false";
    case ValueType::integer:
      return std::to_string(std::get<std::int64_t>(value));
    case ValueType::natural:
      return std::to_string(std::get<std::uint64_t>(value));
    case ValueType::text:
    case ValueType::choice:
      return std::get<std::string>(value);
    case ValueType::number:
    case ValueType::vector2:
    case ValueType::vector3:
      break;
  }
  std::string text;
  for (const double component : components(value))
    text.append(text.empty() ? "" : ", ").append(format_quantity(component, key.dimension));
  return text;
}

SchemaValue value_from_text(const SchemaKey& key, std::string_view text) {
  switch (key.type) {
    case ValueType::boolean:
      if (trim(text) == "true") return true;
      if (trim(text) == "false") return false;
      throw InputError(quote_for_message(text) + " is neither true nor false");
    case ValueType::integer:
      return integer_from_text<std::int64_t>(key, text);
    case ValueType::natural:
      return integer_from_text<std::uint64_t>(key, text);
    case ValueType::number:
      return parse_quantity(text, key.dimension);
    case ValueType::text:
      return std::string(text);
    case ValueType::choice: {
      for (const std::string_view word : key.choices)
        if (word == trim(text)) return std::string(word);
      std::vector<std::string> words(key.choices.begin(), key.choices.end());
      const std::string nearest = nearest_word(trim(text), words);
      throw InputError(quote_for_message(text) + " is not one of " + range_text(key) +
                       (nearest.empty() ? "" : "; did you mean \"" + nearest + "\"?"));
    }
    case ValueType::vector2: {
      const auto c = components_from_text(key, text, 2);
      return Vec2{c[0], c[1]};
    }
    case ValueType::vector3: {
      const auto c = components_from_text(key, text, 3);
      return Vec3{c[0], c[1], c[2]};
    }
  }
  return false;
}

bool in_range(const SchemaKey& key, const SchemaValue& value) {
  if (key.type == ValueType::choice)
    return std::find(key.choices.begin(), key.choices.end(), std::get<std::string>(value)) !=
           key.choices.end();
  for (const double component : components(value))
    if (!in_range(component, key.range)) return false;
  return true;
}

void check_range(const SchemaKey& key, const SchemaValue& value) {
  if (in_range(key, value)) return;
  std::string given = value_to_text(key, value);  // refuses NaN
  if (key.type == ValueType::number || key.type == ValueType::vector2 ||
      key.type == ValueType::vector3) {
    given.clear();
    for (const double component : components(value))
      given.append(given.empty() ? "" : ", ")
          .append(readable_quantity(component, key.dimension, kMessageDigits));
  }
  throw InputError(given + " is not possible here; " + range_text(key) + " is allowed");
}

SchemaValue default_value(const SchemaKey& key) {
  Scene scene;
  std::vector<std::size_t> zeros;
  for (auto at = key.path.find("[]"); at != std::string_view::npos;
       at = key.path.find("[]", at + 2)) {
    const SchemaList* list = find_schema_list(key.path.substr(0, at));
    list->resize(scene, zeros, 1);
    zeros.push_back(0);
  }
  return key.get(scene, zeros);
}

bool is_required(const SchemaKey& key) {
  return !in_range(key, default_value(key));
}

std::string range_text(const SchemaKey& key) {
  std::string text;
  const auto add = [&](const std::string& part) {
    text.append(text.empty() ? "" : ", ").append(part);
  };
  if (key.type == ValueType::choice) {
    for (const std::string_view word : key.choices) add(std::string(word));
    return text;
  }
  if (key.type == ValueType::boolean) return "true or false";
  if (key.type == ValueType::natural) return "0 to 2^64 - 1";
  if (key.type == ValueType::text) return "any text";
  const ValueRange& range = key.range;
  const auto number = [&](double value) {
    return key.type == ValueType::integer ? std::to_string(static_cast<std::int64_t>(value))
                                          : readable_quantity(value, key.dimension, kMessageDigits);
  };
  if (range.nonzero) add("any number but 0");
  const bool from = std::isfinite(range.lower), to = std::isfinite(range.upper);
  if (from && to && !range.above_lower) {
    add(number(range.lower) + " to " + number(range.upper));
    return text;
  }
  if (from) add((range.above_lower ? "above " : "at least ") + number(range.lower));
  if (to) add("at most " + number(range.upper));
  return text.empty() ? "any number" : text;
}

}  // namespace plenoflame
