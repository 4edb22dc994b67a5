#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <limits>

#include "plenoflame/base/printable.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/scene/scene_file.h"
#include "plenoflame/scene/scene_schema.h"

namespace plenoflame {
namespace {

bool is_utf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i]);
    const std::size_t length = lead < 0x80   ? 1
                               : lead < 0xC2 ? 0
                               : lead < 0xE0 ? 2
                               : lead < 0xF0 ? 3
                               : lead < 0xF5 ? 4
                                             : 0;
    if (length == 0 || i + length > text.size()) return false;
    for (std::size_t k = 1; k < length; ++k)
      if ((static_cast<unsigned char>(text[i + k]) & 0xC0) != 0x80) return false;
    i += length;
  }
  return true;
}

/// A TOML basic string.
std::string quote(std::string_view text) {
  if (!is_utf8(text)) throw InputError("a text is not UTF-8");
  constexpr std::string_view digits = "0123456789ABCDEF";
  std::string result = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (code < 0x20 || code == 0x7f) {
      result.append("\\u00").append(1, digits[code >> 4]).append(1, digits[code & 15]);
    } else {
      result += c;
    }
  }
  // Other characters that would act on a terminal are escaped as TOML does.
  return printable(result.append("\""));
}

std::string number_to_toml(double value, Dimension dimension) {
  const std::string text = format_quantity(value, dimension);
  if (dimension != Dimension::none) return quote(text);
  // A TOML number; "-0" would be an integer and lose its sign.
  return text == "-0" ? "-0.0" : text;
}

std::string value_to_toml(const SchemaKey& key, const SchemaValue& value) {
  switch (key.type) {
    case ValueType::text:
    case ValueType::choice:
      return quote(std::get<std::string>(value));
    case ValueType::number:
      return number_to_toml(std::get<double>(value), key.dimension);
    case ValueType::vector2: {
      const auto v = std::get<Vec2>(value);
      return fmt::format("[{}, {}]", number_to_toml(v.x, key.dimension),
                         number_to_toml(v.y, key.dimension));
    }
    case ValueType::vector3: {
      const auto v = std::get<Vec3>(value);
      return fmt::format("[{}, {}, {}]", number_to_toml(v.x, key.dimension),
                         number_to_toml(v.y, key.dimension), number_to_toml(v.z, key.dimension));
    }
    case ValueType::natural:
      if (std::get<std::uint64_t>(value) > std::uint64_t{std::numeric_limits<std::int64_t>::max()})
        return quote(value_to_text(key, value));
      break;
    case ValueType::boolean:
    case ValueType::integer:
      break;
  }
  return value_to_text(key, value);
}

/// Path of the table that holds a key or list: "a.b[].c" -> "a.b[]".
std::string_view parent(std::string_view path) {
  const auto dot = path.rfind('.');
  return dot == std::string_view::npos ? std::string_view() : path.substr(0, dot);
}

std::string_view last_name(std::string_view path) {
  return path.substr(path.rfind('.') + 1);
}

class Writer {
 public:
  explicit Writer(const Scene& scene) : scene_(scene) {}

  std::string text() {
    write_empty_lists("", {});
    write_tables_below("", {});
    return text_;
  }

 private:
  void write_keys(std::string_view table, const std::vector<std::size_t>& indices) {
    for (const SchemaKey& key : schema_keys()) {
      if (parent(key.path) != table) continue;
      const SchemaValue value = key.get(scene_, indices);
      // A value that was never set; absent is what reads back as it.
      if (value == default_value(key) && !in_range(key, value)) continue;
      // Who then changes the glass or the wavelength would have to change the index, too.
      if (key.path == "windows[].index" && !scene_.windows[indices[0]].glass.empty()) continue;
      try {
        text_.append(last_name(key.path))
            .append(" = ")
            .append(value_to_toml(key, value))
            .append("\n");
      } catch (const InputError& error) {
        throw InputError(std::string(key.path) + ": " + error.what());
      }
    }
    write_empty_lists(table, indices);
  }

  /// A list that is empty by default is left out. It reads back as empty, and users can add a table
  /// [[NAME]] to the file, which TOML forbids beside NAME = [].
  void write_empty_lists(std::string_view table, const std::vector<std::size_t>& indices) {
    const Scene untouched;
    for (const SchemaList& list : schema_lists()) {
      if (parent(list.path) != table || list.path == "cameras") continue;
      if (list.size(scene_, indices) != 0) continue;
      if (indices.empty() && list.size(untouched, indices) == 0) continue;
      text_.append(last_name(list.path)).append(" = []\n");
    }
  }

  void write_tables_below(std::string_view table, const std::vector<std::size_t>& indices) {
    for (const SchemaTable& row : schema_tables()) {
      if (parent(row.path) != table) continue;
      if (row.path == "camera" && !scene_.cameras.empty()) continue;
      if (!row.path.ends_with("[]")) {
        write_table("[", row.path, indices);
        continue;
      }
      const SchemaList* list = find_schema_list(row.path.substr(0, row.path.size() - 2));
      const std::size_t size = list->size(scene_, indices);
      for (std::size_t i = 0; i < size; ++i) {
        std::vector<std::size_t> deeper = indices;
        deeper.push_back(i);
        write_table("[[", row.path, deeper);
      }
    }
  }

  void write_table(std::string_view bracket, std::string_view table,
                   const std::vector<std::size_t>& indices) {
    std::string header(bracket);
    for (const char c : table)
      if (c != '[' && c != ']') header += c;
    header.append(bracket.size(), ']');
    text_.append(text_.empty() ? "" : "\n").append(header).append("\n");
    write_keys(table, indices);
    write_tables_below(table, indices);
  }

  const Scene& scene_;
  std::string text_;
};

}  // namespace

std::string write_scene(const Scene& scene) {
  return Writer(scene).text();
}

void write_scene_file(const std::string& path, const Scene& scene) {
  write_file(path, write_scene(scene));
}

}  // namespace plenoflame
