#include "plenoflame/volumes/grid_file.h"
#include "plenoflame/base/constants.h"

#include <fmt/format.h>
#include <openvdb/io/io.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <charconv>
#include <memory>
#include <string_view>

#include "field.h"
#include "openvdb_support.h"
#include "plenoflame/base/error.h"
#include "plenoflame/volumes/interop.h"
#include "vdb_bytes.h"
#include "vdb_container.h"
#include "vdb_tree_check.h"

namespace plenoflame {
namespace {

using detail::Container;
using detail::Damaged;
using detail::GridEntry;

constexpr std::string_view kFloatTree = "Tree_float_5_4_3";
constexpr std::string_view kDoubleTree = "Tree_double_5_4_3";

/// Calls action() and puts the file's name in front of whatever goes wrong.
template <class Action>
auto naming_file(const std::string& path, Action&& action) {
  try {
    return action();
  } catch (const Damaged& damage) {
    throw FileError(fmt::format("{}: cannot be read: {}", path, damage.what()));
  } catch (const openvdb::Exception& error) {
    throw FileError(fmt::format("{}: is damaged ({})", path, error.what()));
  } catch (const std::ios_base::failure&) {
    throw FileError(fmt::format("{}: is truncated or damaged", path));
  }
}

struct OpenFile {
  std::string path;
  std::vector<char> bytes;
  Container container;
};

OpenFile open(const std::string& path) {
  openvdb::initialize();
  OpenFile file{path, detail::read_bytes(path), {}};
  file.container = naming_file(path, [&] { return detail::parse_container(file.bytes); });
  return file;
}

std::unique_ptr<detail::MemoryStream> stream_at(const OpenFile& file, const GridEntry& grid) {
  auto stream = std::make_unique<detail::MemoryStream>(file.bytes.data(), file.bytes.size());
  stream->seekg(static_cast<std::streamoff>(grid.transform_position));
  openvdb::io::setVersion(*stream, {file.container.library_major, file.container.library_minor},
                          file.container.file_version);
  openvdb::io::setDataCompression(*stream, grid.compression);
  return stream;
}

/// OpenVDB's name of the grid's map.
std::string transform_type(const OpenFile& file, const GridEntry& grid) {
  detail::ByteReader reader(file.bytes.data(), file.bytes.size());
  reader.seek(grid.transform_position);
  return reader.text();
}

/// The affine maps. All others (frustums) are listed by name and not read.
bool is_affine(const std::string& type) {
  for (const char* affine : {"AffineMap", "ScaleMap", "UniformScaleMap", "TranslationMap",
                             "ScaleTranslateMap", "UniformScaleTranslateMap", "UnitaryMap"})
    if (type == affine) return true;
  return false;
}

openvdb::math::Transform::Ptr read_transform(std::istream& stream) {
  auto transform = openvdb::math::Transform::createLinearTransform();
  transform->read(stream);
  return transform;
}

/// The entry whose tree this grid uses: itself, or the one that it is an instance of.
const GridEntry& tree_owner(const OpenFile& file, const GridEntry& grid) {
  if (grid.instance_parent.empty()) return grid;
  for (const GridEntry& other : file.container.grids)
    if (other.unique_name == grid.instance_parent && other.instance_parent.empty()) return other;
  throw Damaged(fmt::format("the grid that \"{}\" shares its voxels with is missing", grid.name));
}

template <class Grid>
typename Grid::Ptr read_tree(const OpenFile& file, const GridEntry& grid) {
  const GridEntry& owner = tree_owner(file, grid);
  if (owner.tree_type != grid.tree_type) throw Damaged("two grids of different types share voxels");
  if (!is_affine(transform_type(file, owner))) throw Damaged("a grid's transform cannot be read");
  const auto transform = read_transform(*stream_at(file, grid));
  const auto stream = stream_at(file, owner);
  read_transform(*stream);
  detail::ByteReader check(file.bytes.data(), file.bytes.size());
  check.seek(static_cast<std::size_t>(stream->tellg()));
  detail::check_tree(check, sizeof(typename Grid::ValueType), owner.half, owner.compression);
  const auto result = Grid::create();
  result->setName(grid.name);
  result->setTransform(transform);
  result->setSaveFloatAsHalf(owner.half);
  result->readTopology(*stream);
  result->readBuffers(*stream);
  return result;
}

std::string value_type(const GridEntry& grid) {
  std::string_view type = grid.tree_type;
  if (!type.starts_with("Tree_")) return grid.tree_type;
  type.remove_prefix(5);
  const std::size_t end = type.find('_');
  return std::string(type.substr(0, end));
}

template <class T>
std::vector<T> metadata_numbers(const GridEntry& grid, const char* key) {
  std::vector<T> numbers;
  const auto entry = grid.metadata.find(key);
  if (entry == grid.metadata.end()) return numbers;
  const std::string& text = entry->second;
  const char* at = text.data();
  const char* end = text.data() + text.size();
  while (at < end) {
    T value{};
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc()) return {};
    numbers.push_back(value);
    at = next;
    while (at < end && (*at == ',' || *at == ' ')) ++at;
  }
  return numbers;
}

template <class Grid>
void add_statistics(const Grid& grid, GridInfo& info) {
  info.background = static_cast<double>(grid.background());
  info.active_voxels = grid.activeVoxelCount();
  const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
  if (info.active_voxels > 0)
    for (int axis = 0; axis < 3; ++axis) {
      info.index_lower[static_cast<std::size_t>(axis)] = box.min()[axis];
      info.index_upper[static_cast<std::size_t>(axis)] = box.max()[axis];
    }
  bool first = true;
  for (auto value = grid.cbeginValueOn(); value; ++value) {
    const auto v = static_cast<double>(*value);
    if (first || v < info.minimum) info.minimum = v;
    if (first || v > info.maximum) info.maximum = v;
    first = false;
  }
}

void statistics_from_metadata(const GridEntry& grid, GridInfo& info) {
  const auto count = metadata_numbers<std::int64_t>(grid, "file_voxel_count");
  const auto lower = metadata_numbers<int>(grid, "file_bbox_min");
  const auto upper = metadata_numbers<int>(grid, "file_bbox_max");
  if (count.size() == 1 && count[0] > 0) info.active_voxels = static_cast<std::uint64_t>(count[0]);
  if (info.active_voxels > 0 && lower.size() == 3 && upper.size() == 3) {
    std::copy_n(lower.begin(), 3, info.index_lower.begin());
    std::copy_n(upper.begin(), 3, info.index_upper.begin());
  }
}

void add_world_bounds(GridInfo& info) {
  if (info.index_lower[0] > info.index_upper[0]) return;
  Box box{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
  for (int corner = 0; corner < 8; ++corner) {
    const auto at = [&](int axis) {
      const auto a = static_cast<std::size_t>(axis);
      return static_cast<double>((corner >> axis & 1) != 0 ? info.index_upper[a]
                                                           : info.index_lower[a]);
    };
    const Vec3 p = info.index_to_world.point({at(0), at(1), at(2)});
    box.lower = {std::min(box.lower.x, p.x), std::min(box.lower.y, p.y),
                 std::min(box.lower.z, p.z)};
    box.upper = {std::max(box.upper.x, p.x), std::max(box.upper.y, p.y),
                 std::max(box.upper.z, p.z)};
  }
  info.world_bounds = box;
}

GridInfo describe(const OpenFile& file, const GridEntry& grid, bool statistics) {
  GridInfo info;
  info.name = grid.name;
  info.value_type = value_type(grid);
  info.half = grid.half;
  info.metadata = grid.metadata;
  const auto take = [&](const char* key) {
    const auto node = info.metadata.extract(key);
    return node.empty() ? std::string() : node.mapped();
  };
  info.unit = take("unit");
  if (info.unit.empty()) info.unit = take("units");
  info.grid_class = take("class");
  if (info.grid_class == "unknown") info.grid_class.clear();
  take("name");

  info.transform_type = transform_type(file, grid);
  if (!is_affine(info.transform_type)) {
    if (statistics) statistics_from_metadata(grid, info);
    return info;
  }
  info.index_to_world = detail::affine_of(*read_transform(*stream_at(file, grid)));
  const Mat3 columns = transpose(info.index_to_world.linear);
  info.voxel_size =
      std::min({length(columns.rows[0]), length(columns.rows[1]), length(columns.rows[2])});
  const bool is_float = grid.tree_type == kFloatTree, is_double = grid.tree_type == kDoubleTree;
  info.readable = (is_float || is_double) && detail::is_regular(info.index_to_world);
  if (!statistics) return info;
  if (is_float)
    add_statistics(*read_tree<openvdb::FloatGrid>(file, grid), info);
  else if (is_double)
    add_statistics(*read_tree<openvdb::DoubleGrid>(file, grid), info);
  else
    statistics_from_metadata(grid, info);
  add_world_bounds(info);
  return info;
}

std::string names_of(const Container& container) {
  std::string names;
  for (const GridEntry& grid : container.grids)
    names += fmt::format("{}\"{}\" ({})", names.empty() ? "" : ", ", grid.name, value_type(grid));
  return names.empty() ? "none" : names;
}

/// "name" is the first grid of that name, "name[2]" the third.
const GridEntry& find(const OpenFile& file, const std::string& name) {
  for (const GridEntry& grid : file.container.grids)
    if (grid.name == name) return grid;
  const std::size_t bracket = name.rfind('[');
  if (bracket != std::string::npos && name.ends_with(']')) {
    std::string unique = name.substr(0, bracket) + '\x1e' + name.substr(bracket + 1);
    unique.pop_back();
    for (const GridEntry& grid : file.container.grids)
      if (grid.unique_name == unique) return grid;
  }
  throw InputError(fmt::format("{}: has no grid \"{}\"; it holds: {}", file.path, name,
                               names_of(file.container)));
}

}  // namespace

std::vector<GridInfo> list_grids(const std::string& path, bool statistics) {
  const OpenFile file = open(path);
  return naming_file(path, [&] {
    std::vector<GridInfo> grids;
    for (const GridEntry& grid : file.container.grids)
      grids.push_back(describe(file, grid, statistics));
    return grids;
  });
}

VoxelField read_voxel_field(const std::string& path, const std::string& name) {
  const OpenFile file = open(path);
  const GridEntry& grid = find(file, name);
  return naming_file(path, [&] {
    const auto converted = [&](const auto& vdb) {
      try {
        return from_openvdb(vdb);
      } catch (const InputError& error) {
        throw InputError(fmt::format("{}: grid \"{}\": {}", path, name, error.what()));
      }
    };
    if (!is_affine(transform_type(file, grid)))
      throw InputError(fmt::format(
          "{}: grid \"{}\" has a transform of type {} (perspective), and only affine ones can be "
          "used; resample it to a box of voxels",
          path, name, transform_type(file, grid)));
    if (grid.tree_type == kFloatTree) return converted(*read_tree<openvdb::FloatGrid>(file, grid));
    if (grid.tree_type == kDoubleTree)
      return converted(*read_tree<openvdb::DoubleGrid>(file, grid));
    throw InputError(
        fmt::format("{}: grid \"{}\" has values of type {}; a flame needs a float or double grid; "
                    "the file holds: {}",
                    path, name, value_type(grid), names_of(file.container)));
  });
}

}  // namespace plenoflame
