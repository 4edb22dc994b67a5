#include "vdb_container.h"

#include <fmt/format.h>

#include <string_view>

namespace plenoflame::detail {
namespace {

constexpr std::int64_t kMagic = 0x56444220;
constexpr std::uint32_t kOldestVersion = 222;  // node mask compression
constexpr std::uint32_t kNewestVersion = 224;
constexpr char kSeparator = '\x1e';  // between a name and the number that makes it unique

template <class T>
std::string numbers(ByteReader& value, int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += fmt::format("{}{}", i > 0 ? ", " : "", value.value<T>());
  return text;
}

/// A metadata value as text; empty for types that have none.
std::string metadata_text(const std::string& type, const char* data, std::size_t size) {
  ByteReader value(data, size);
  try {
    if (type == "string") return {data, size};
    if (type == "bool") return value.value<char>() != 0 ? "true" : "false";
    if (type == "int32") return numbers<std::int32_t>(value, 1);
    if (type == "int64") return numbers<std::int64_t>(value, 1);
    if (type == "float") return numbers<float>(value, 1);
    if (type == "double") return numbers<double>(value, 1);
    if (type == "vec2i") return numbers<std::int32_t>(value, 2);
    if (type == "vec3i") return numbers<std::int32_t>(value, 3);
    if (type == "vec2s") return numbers<float>(value, 2);
    if (type == "vec3s") return numbers<float>(value, 3);
    if (type == "vec2d") return numbers<double>(value, 2);
    if (type == "vec3d") return numbers<double>(value, 3);
  } catch (const Damaged&) {
    throw Damaged("a metadata value is shorter than its type");
  }
  return {};
}

std::map<std::string, std::string> read_metadata(ByteReader& file) {
  std::map<std::string, std::string> metadata;
  const auto count = file.value<std::uint32_t>();
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::string name = file.text();
    const std::string type = file.text();
    const auto size = file.value<std::uint32_t>();
    const char* data = file.take(size);
    std::string text = metadata_text(type, data, size);
    if (!text.empty()) metadata[name] = std::move(text);
  }
  return metadata;
}

bool remove_suffix(std::string& text, std::string_view suffix) {
  if (!text.ends_with(suffix)) return false;
  text.resize(text.size() - suffix.size());
  return true;
}

}  // namespace

Container parse_container(const std::vector<char>& bytes) {
  ByteReader file(bytes.data(), bytes.size());
  Container container;
  if (bytes.size() < sizeof(kMagic) || file.value<std::int64_t>() != kMagic)
    throw Damaged("it is not a .vdb file");
  container.file_version = file.value<std::uint32_t>();
  if (container.file_version < kOldestVersion || container.file_version > kNewestVersion)
    throw Damaged(
        fmt::format("it has file version {}, and only {} to {} can be read; save it again "
                    "with a current program",
                    container.file_version, kOldestVersion, kNewestVersion));
  container.library_major = file.value<std::uint32_t>();
  container.library_minor = file.value<std::uint32_t>();
  const bool has_offsets = file.value<char>() != 0;
  file.take(36);  // UUID
  read_metadata(file);
  const auto count = file.value<std::int32_t>();
  if (count < 0) throw Damaged("the number of grids is negative");
  if (count > 0 && !has_offsets)
    throw Damaged("it was written as a stream, without the places of its grids; save it as a file");

  for (std::int32_t i = 0; i < count; ++i) {
    GridEntry grid;
    grid.unique_name = file.text();
    grid.name = grid.unique_name.substr(0, grid.unique_name.find(kSeparator));
    grid.tree_type = file.text();
    grid.half = remove_suffix(grid.tree_type, "_HalfFloat");
    grid.instance_parent = file.text();
    const auto grid_position = file.value<std::int64_t>();
    file.value<std::int64_t>();  // of the leaf values
    const auto end_position = file.value<std::int64_t>();
    if (grid_position < 0 || end_position < grid_position)
      throw Damaged("the place of a grid is wrong");
    file.seek(static_cast<std::size_t>(grid_position));
    grid.compression = file.value<std::uint32_t>();
    grid.metadata = read_metadata(file);
    grid.transform_position = file.position();
    file.seek(static_cast<std::size_t>(end_position));
    container.grids.push_back(std::move(grid));
  }
  return container;
}

}  // namespace plenoflame::detail
