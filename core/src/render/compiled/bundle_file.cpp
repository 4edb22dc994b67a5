#include "render/compiled/bundle_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <memory>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

#include "plenoflame/base/error.h"
#include "plenoflame/base/version.h"
#include "plenoflame/film/film.h"
#include "plenoflame/image/atomic_file.h"

namespace plenoflame {
namespace {

using Json = nlohmann::json;

// Layout: magic, size of the header, its checksum, the header (JSON) padded with blanks. Tiles,
// groups and nodes follow as they are in memory (little-endian).
constexpr std::string_view kBundleMagic = "plenoflame bundle 1\n";
constexpr std::size_t kAlignment = 64;
constexpr std::size_t kPreamble = 64;  ///< bytes before the header

static_assert(sizeof(CompiledNode) == 12 && sizeof(CompiledGroup) == 40 &&
              sizeof(CompiledTile) == 40);

template <class T>
std::string_view bytes_of(std::span<const T> items) {
  return {reinterpret_cast<const char*>(items.data()), items.size_bytes()};
}

std::uint32_t crc(std::uint32_t start, std::string_view bytes) {
  // zlib takes sizes as unsigned int.
  constexpr std::size_t kMost = std::size_t{1} << 30;
  uLong sum = start;
  for (; !bytes.empty(); bytes.remove_prefix(std::min(kMost, bytes.size())))
    sum = crc32(sum, reinterpret_cast<const Bytef*>(bytes.data()),
                static_cast<uInt>(std::min(kMost, bytes.size())));
  return static_cast<std::uint32_t>(sum);
}

std::size_t aligned(std::size_t size) {
  return (size + kAlignment - 1) / kAlignment * kAlignment;
}

Json vector_json(Vec3 v) {
  return {v.x, v.y, v.z};
}

Vec3 vector_of(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

std::string header_of(const CompiledCamera& camera) {
  const PixelWindow& w = camera.window;
  Json json;
  json["version"] = camera.version;
  json["key"] = camera.key;
  json["window"] = {w.x, w.y, w.width, w.height};
  json["sensor"] = {camera.sensor_width, camera.sensor_height};
  json["region"] = {vector_json(camera.region.lower), vector_json(camera.region.upper)};
  json["frame"] = {vector_json(camera.anchor), vector_json(camera.across), vector_json(camera.down),
                   vector_json(camera.along)};
  json["error"] = camera.error;
  json["samples"] = camera.samples;
  json["level"] = camera.level;
  json["seed"] = camera.seed;
  json["tiles"] = camera.tiles.size();
  json["groups"] = camera.groups;
  json["nodes"] = camera.nodes;
  json["tiles_checksum"] = crc(0, bytes_of<CompiledTile>(camera.tiles));
  std::string text = json.dump();
  text.resize(aligned(text.size()), ' ');
  return text;
}

/// An open bundle, read in pieces as they are needed. Lengths and checksums detect changes of the
/// file. The file is never mapped into memory.
class OpenBundle {
 public:
  explicit OpenBundle(const std::string& path) : path_(path) {
    // O_NONBLOCK avoids waiting for the writer of a pipe.
    file_ = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (file_ < 0) fail();
    struct stat status {};
    if (::fstat(file_, &status) != 0 || !S_ISREG(status.st_mode)) {
      ::close(file_);
      throw FileError("cannot read '" + path + "': it is not a file");
    }
    size_ = static_cast<std::uint64_t>(status.st_size);
  }
  ~OpenBundle() { ::close(file_); }
  OpenBundle(const OpenBundle&) = delete;
  OpenBundle& operator=(const OpenBundle&) = delete;

  std::uint64_t size() const { return size_; }

  /// @param count of items; the file was long enough for them when it was opened
  template <class T>
  std::vector<T> read(std::uint64_t at, std::uint64_t count) const {
    std::vector<T> items(static_cast<std::size_t>(count));
    char* to = reinterpret_cast<char*>(items.data());
    for (std::uint64_t left = count * sizeof(T); left > 0;) {
      constexpr std::uint64_t kMost = std::uint64_t{1} << 30;  // bytes of one call
      const ssize_t got = ::pread(file_, to, static_cast<std::size_t>(std::min(left, kMost)),
                                  static_cast<off_t>(at));
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) fail();
      if (got == 0)
        throw FileError(path_ + ": was cut off while it was read; compile the camera again");
      to += got, at += static_cast<std::uint64_t>(got), left -= static_cast<std::uint64_t>(got);
    }
    return items;
  }

 private:
  [[noreturn]] void fail() const {
    throw FileError("cannot read '" + path_ + "': " + std::strerror(errno));
  }
  std::string path_;
  int file_ = -1;
  std::uint64_t size_ = 0;
};

/// Checks that the groups and nodes of each tile follow those of the tile before.
bool are_in_order(const CompiledCamera& camera) {
  std::uint64_t group = 0, node = 0;
  for (const CompiledTile& tile : camera.tiles) {
    if (tile.first_group != group || tile.first_node != node ||
        tile.groups > camera.groups - group || tile.nodes > camera.nodes - node)
      return false;
    group += tile.groups, node += tile.nodes;
  }
  return group == camera.groups && node == camera.nodes;
}

bool is_finite(Vec3 v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

bool is_unit(Vec3 v) {
  return std::fabs(dot(v, v) - 1) < 1e-6;
}

bool is_sound(const CompiledCamera& camera) {
  const PixelWindow& w = camera.window;
  return w.x >= 0 && w.y >= 0 && w.width > 0 && w.height > 0 && camera.sensor_width >= w.width &&
         camera.sensor_height >= w.height && w.x <= camera.sensor_width - w.width &&
         w.y <= camera.sensor_height - w.height && is_finite(camera.region.lower) &&
         is_finite(camera.region.upper) && is_finite(camera.anchor) && is_unit(camera.across) &&
         is_unit(camera.down) && is_unit(camera.along) && std::isfinite(camera.error) &&
         camera.samples > 0;
}

/// Number of tiles of a Film of this window, computed without allocating the film.
std::uint64_t tiles_of(const PixelWindow& window) {
  const auto along = [](int pixels) {
    return (static_cast<std::uint64_t>(pixels) + Film::kTile - 1) / Film::kTile;
  };
  return along(window.width) * along(window.height);
}

/// Checks that places, slopes and weights are possible values for a camera.
bool is_sound(const CompiledContent& content) {
  constexpr float kFarthest = 1e9F;  // [m]; also the limit of slopes
  std::uint64_t nodes = 0;
  for (const CompiledGroup& group : content.groups) {
    nodes += std::uint64_t{group.count[0]} + group.count[1];
    if (group.pixel >= Film::kTile * Film::kTile) return false;
    for (std::size_t k = 0; k < 4; ++k)
      if (!(std::fabs(group.lower[k]) <= kFarthest) ||
          !(group.step[k] >= 0 && group.step[k] <= kFarthest))
        return false;
  }
  return nodes == content.nodes.size() &&
         std::all_of(content.nodes.begin(), content.nodes.end(), [](const CompiledNode& node) {
           return node.weight >= 0 && node.weight <= 1;  // [m^2 sr] of a pixel
         });
}

void read_header(const Json& json, CompiledCamera& camera) {
  camera.version = json.at("version").get<std::string>();
  camera.key = json.at("key").get<std::string>();
  const Json& w = json.at("window");
  camera.window = {w.at(0).get<int>(), w.at(1).get<int>(), w.at(2).get<int>(), w.at(3).get<int>()};
  camera.sensor_width = json.at("sensor").at(0).get<int>();
  camera.sensor_height = json.at("sensor").at(1).get<int>();
  camera.region = {vector_of(json.at("region").at(0)), vector_of(json.at("region").at(1))};
  const Json& frame = json.at("frame");
  camera.anchor = vector_of(frame.at(0));
  camera.across = vector_of(frame.at(1));
  camera.down = vector_of(frame.at(2));
  camera.along = vector_of(frame.at(3));
  camera.error = json.at("error").get<double>();
  camera.samples = json.at("samples").get<int>();
  camera.level = json.at("level").get<int>();
  camera.seed = json.at("seed").get<std::uint64_t>();
}

}  // namespace

std::uint32_t tile_checksum(std::span<const CompiledGroup> groups,
                            std::span<const CompiledNode> nodes) {
  return crc(crc(0, bytes_of(groups)), bytes_of(nodes));
}

void write_bundle(const std::string& path, const CompiledCamera& camera) {
  const std::string header = header_of(camera);
  const std::uint64_t size = header.size(), sum = crc(0, header);
  std::string preamble(kBundleMagic);
  preamble.append(reinterpret_cast<const char*>(&size), sizeof size);
  preamble.append(reinterpret_cast<const char*>(&sum), sizeof sum);
  preamble.resize(kPreamble, '\0');
  AtomicFile file(path);
  file.write(preamble);
  file.write(header);
  file.write(bytes_of<CompiledTile>(camera.tiles));
  for (std::size_t t = 0; t < camera.tiles.size(); ++t)
    file.write(bytes_of<CompiledGroup>(camera.content(t).groups));
  for (std::size_t t = 0; t < camera.tiles.size(); ++t)
    file.write(bytes_of<CompiledNode>(camera.content(t).nodes));
  file.commit();
}

CompiledCamera read_bundle(const std::string& path) {
  const auto file = std::make_shared<const OpenBundle>(path);
  const std::string again = "; compile the camera again";
  constexpr std::string_view kAnyVersion = "plenoflame bundle ";
  const std::vector<char> begin =
      file->read<char>(0, std::min<std::uint64_t>(kPreamble, file->size()));
  const std::string_view preamble(begin.data(), begin.size());
  if (preamble.substr(0, kAnyVersion.size()) != kAnyVersion)
    throw InputError(path +
                     ": is not a compiled camera; `plenoflame compile` makes one of a scene");
  if (preamble.substr(0, kBundleMagic.size()) != kBundleMagic)
    throw FileError(path + ": was written by another version of Plenoflame" + again);
  const FileError cut_off(path + ": is cut off" + again), damaged(path + ": is damaged" + again);
  if (preamble.size() < kPreamble) throw cut_off;
  std::uint64_t size = 0, sum = 0;
  std::memcpy(&size, preamble.data() + kBundleMagic.size(), sizeof size);
  std::memcpy(&sum, preamble.data() + kBundleMagic.size() + sizeof size, sizeof sum);
  if (size % kAlignment != 0) throw damaged;
  if (size > file->size() - kPreamble) throw cut_off;
  const std::vector<char> header = file->read<char>(kPreamble, size);
  if (crc(0, {header.data(), header.size()}) != sum) throw damaged;
  CompiledCamera camera;
  std::uint64_t tiles = 0, tiles_sum = 0;
  try {
    const Json json = Json::parse(header);
    read_header(json, camera);
    tiles = json.at("tiles").get<std::uint64_t>();
    camera.groups = json.at("groups").get<std::uint64_t>();
    camera.nodes = json.at("nodes").get<std::uint64_t>();
    tiles_sum = json.at("tiles_checksum").get<std::uint64_t>();
  } catch (const Json::exception&) {
    throw damaged;
  }
  const std::uint64_t left = file->size() - kPreamble - size;
  if (!is_sound(camera) || tiles != tiles_of(camera.window)) throw damaged;
  if (tiles > left / sizeof(CompiledTile) || camera.groups > left / sizeof(CompiledGroup) ||
      camera.nodes > left / sizeof(CompiledNode))
    throw cut_off;
  const std::uint64_t first_tile = kPreamble + size,
                      first_group = first_tile + tiles * sizeof(CompiledTile),
                      first_node = first_group + camera.groups * sizeof(CompiledGroup),
                      end = first_node + camera.nodes * sizeof(CompiledNode);
  if (file->size() < end) throw cut_off;
  if (file->size() > end) throw damaged;
  camera.tiles = file->read<CompiledTile>(first_tile, tiles);
  if (crc(0, bytes_of<CompiledTile>(camera.tiles)) != tiles_sum || !are_in_order(camera))
    throw damaged;
  const auto table = std::make_shared<const std::vector<CompiledTile>>(camera.tiles);
  camera.content = [=](std::size_t number) {
    const CompiledTile& tile = table->at(number);
    CompiledContent content;
    content.groups = file->read<CompiledGroup>(
        first_group + tile.first_group * sizeof(CompiledGroup), tile.groups);
    content.nodes =
        file->read<CompiledNode>(first_node + tile.first_node * sizeof(CompiledNode), tile.nodes);
    if (tile_checksum(content.groups, content.nodes) != tile.checksum || !is_sound(content))
      throw damaged;
    return content;
  };
  return camera;
}

}  // namespace plenoflame
