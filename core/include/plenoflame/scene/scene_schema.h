#pragma once
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "plenoflame/base/units.h"
#include "plenoflame/scene/presets.h"
#include "plenoflame/scene/scene.h"

/// The one table that describes every key of a scene file. The reader, the writer, the reference
/// page, the checks of ranges and the forms of the desktop application all follow it.
///
/// A path names a value: "camera.lens.surfaces[2].radius". Its schema path has empty brackets:
/// "camera.lens.surfaces[].radius".
namespace plenoflame {

enum class ValueType {
  boolean,
  integer,
  natural,  ///< up to 2^64 - 1; in files beyond 2^63 - 1 as text
  number,   ///< with the unit of its dimension
  text,
  choice,  ///< one of a list of words
  vector2,
  vector3,  ///< components are numbers with the unit of the dimension
};

using SchemaValue =
    std::variant<bool, std::int64_t, std::uint64_t, double, std::string, Vec2, Vec3>;

/// The range of a number, in SI units.
struct ValueRange {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  bool above_lower = false;  ///< the lower bound itself is excluded
  bool nonzero = false;
};

/// The numbers of the items that are meant in the lists along a path, outermost first.
using SchemaIndices = std::span<const std::size_t>;

struct SchemaKey {
  std::string_view path;  ///< with empty brackets for list items
  ValueType type;
  Dimension dimension;
  ValueRange range;                           ///< of a number, integer or each component
  std::span<const std::string_view> choices;  ///< of a choice
  std::string_view description;               ///< one sentence
  SchemaValue (*get)(const Scene&, SchemaIndices);
  void (*set)(Scene&, SchemaIndices, const SchemaValue&);  ///< does not check the range
};

/// A list of tables, in files "[[flames]]".
struct SchemaList {
  std::string_view path;  ///< without trailing brackets
  std::size_t fewest, most;
  std::size_t (*size)(const Scene&, SchemaIndices);
  void (*resize)(Scene&, SchemaIndices, std::size_t);
  void (*insert)(Scene&, SchemaIndices, std::size_t);  ///< a default item before that one
  void (*erase)(Scene&, SchemaIndices, std::size_t);
};

/// A table of keys, in files "[camera.lens]"; list items are tables too ("flames[]").
struct SchemaTable {
  std::string_view path;
  std::string_view description;
  bool has_preset;  ///< takes the key "preset"
  PresetKind preset;
};

/// Keys in the order in which they are written; those of one table stand together.
std::span<const SchemaKey> schema_keys();
std::span<const SchemaList> schema_lists();
std::span<const SchemaTable> schema_tables();

/// The key of a path with or without indices; null when there is none.
const SchemaKey* find_schema_key(std::string_view path);
const SchemaList* find_schema_list(std::string_view path);

/// "flames[3].layers[0].name" -> "flames[].layers[].name", and the indices {3, 0}.
/// @throws InputError when a bracket is malformed
struct ParsedPath {
  std::string schema_path;
  std::vector<std::size_t> indices;
};
ParsedPath parse_path(std::string_view path);

/// Every path that a scene has values for, with indices, in writing order.
std::vector<std::string> scene_paths(const Scene& scene);

/// The value at a path as text with a unit ("100 um", "1 m, 0 m, -29 mm", "true", "hexagonal").
/// @throws InputError for an unknown path or an index that does not exist
std::string get_text(const Scene& scene, std::string_view path);

/// Sets a value from text as get_text() returns it.
/// @throws InputError for an unknown path, a missing or wrong unit, a value out of range, or an
///         unknown choice. The scene is then unchanged.
void set_text(Scene& scene, std::string_view path, std::string_view text);

std::size_t list_size(const Scene& scene, std::string_view path);
/// Inserts a default item before `position`, or removes the one there. A camera that is inserted is
/// a copy of the one before it (insert_camera() in cameras.h).
/// @throws InputError for an unknown list, an index that does not exist, or too many items
void insert_item(Scene& scene, std::string_view path, std::size_t position);
void erase_item(Scene& scene, std::string_view path, std::size_t position);

/// Text of a value of this key, and back. @throws InputError as set_text
std::string value_to_text(const SchemaKey& key, const SchemaValue& value);
SchemaValue value_from_text(const SchemaKey& key, std::string_view text);

/// @throws InputError saying what is allowed when the value is out of the key's range
void check_range(const SchemaKey& key, const SchemaValue& value);
bool in_range(const SchemaKey& key, const SchemaValue& value);

/// The value of a key that a file does not give; out of its range when it must be given.
SchemaValue default_value(const SchemaKey& key);
bool is_required(const SchemaKey& key);

/// The allowed range, in words: "> 0 m, at most 1 m".
std::string range_text(const SchemaKey& key);

/// The reference page docs/reference/scene.md.
std::string scene_reference_markdown();

}  // namespace plenoflame
