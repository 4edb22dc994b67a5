#include "render/compiled/bundle_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <cerrno>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <string_view>

#include "plenoflame/base/error.h"
#include "plenoflame/base/version.h"
#include "plenoflame/film/film.h"
#include "plenoflame/image/atomic_file.h"

namespace plenoflame {
namespace {

using Json = nlohmann::json;

// magic, size of the header, its checksum, the header (JSON) filled up with blanks; tiles, groups,
// nodes as they are in memory (little-endian).
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
  // zlib counts in unsigned int.
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
  json["groups"] = camera.groups.size();
  json["nodes"] = camera.nodes.size();
  json["tiles_checksum"] = crc(0, bytes_of(camera.tiles));
  std::string text = json.dump();
  text.resize(aligned(text.size()), ' ');
  return text;
}

/// A file in memory, as long as it lives.
class MappedFile {
 public:
  explicit MappedFile(const std::string& path) {
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0) fail(path);
    struct stat status {};
    if (::fstat(file, &status) != 0 || !S_ISREG(status.st_mode)) {
      ::close(file);
      throw FileError("cannot read '" + path + "': it is not a file");
    }
    size_ = static_cast<std::size_t>(status.st_size);
    if (size_ > 0) data_ = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, file, 0);
    const int error = errno;
    ::close(file);
    if (data_ == MAP_FAILED) {
      data_ = nullptr;
      errno = error;
      fail(path);
    }
  }
  ~MappedFile() {
    if (data_) ::munmap(data_, size_);
  }
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  std::string_view bytes() const { return {static_cast<const char*>(data_), size_}; }

 private:
  [[noreturn]] static void fail(const std::string& path) {
    throw FileError("cannot read '" + path + "': " + std::strerror(errno));
  }
  void* data_ = nullptr;
  std::size_t size_ = 0;
};

template <class T>
std::span<const T> items_at(std::string_view bytes, std::size_t begin, std::size_t count) {
  return {reinterpret_cast<const T*>(bytes.data() + begin), count};
}

/// Every tile's groups and nodes follow those of the one before.
bool are_in_order(const CompiledCamera& camera) {
  std::uint64_t group = 0, node = 0;
  for (const CompiledTile& tile : camera.tiles) {
    if (tile.first_group != group || tile.first_node != node ||
        tile.groups > camera.groups.size() - group || tile.nodes > camera.nodes.size() - node)
      return false;
    group += tile.groups, node += tile.nodes;
  }
  return group == camera.groups.size() && node == camera.nodes.size();
}

bool is_sound(const CompiledCamera& camera) {
  const PixelWindow& w = camera.window;
  return w.x >= 0 && w.y >= 0 && w.width > 0 && w.height > 0 && camera.sensor_width >= w.width &&
         camera.sensor_height >= w.height && w.x <= camera.sensor_width - w.width &&
         w.y <= camera.sensor_height - w.height;
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
  file.write(bytes_of(camera.tiles));
  file.write(bytes_of(camera.groups));
  file.write(bytes_of(camera.nodes));
  file.commit();
}

CompiledCamera read_bundle(const std::string& path) {
  const auto file = std::make_shared<const MappedFile>(path);
  const std::string_view bytes = file->bytes();
  const std::string again = "; compile the camera again";
  constexpr std::string_view kAnyVersion = "plenoflame bundle ";
  if (bytes.substr(0, kAnyVersion.size()) != kAnyVersion)
    throw InputError(path +
                     ": is not a compiled camera; `plenoflame compile` makes one of a scene");
  if (bytes.substr(0, kBundleMagic.size()) != kBundleMagic)
    throw FileError(path + ": was written by another version of Plenoflame" + again);
  const FileError cut_off(path + ": is cut off" + again), damaged(path + ": is damaged" + again);
  if (bytes.size() < kPreamble) throw cut_off;
  std::uint64_t size = 0, sum = 0;
  std::memcpy(&size, bytes.data() + kBundleMagic.size(), sizeof size);
  std::memcpy(&sum, bytes.data() + kBundleMagic.size() + sizeof size, sizeof sum);
  if (size % kAlignment != 0) throw damaged;
  if (size > bytes.size() - kPreamble) throw cut_off;
  const std::string_view header = bytes.substr(kPreamble, static_cast<std::size_t>(size));
  if (crc(0, header) != sum) throw damaged;
  CompiledCamera camera;
  std::uint64_t tiles = 0, groups = 0, nodes = 0, tiles_sum = 0;
  try {
    const Json json = Json::parse(header);
    read_header(json, camera);
    tiles = json.at("tiles").get<std::uint64_t>();
    groups = json.at("groups").get<std::uint64_t>();
    nodes = json.at("nodes").get<std::uint64_t>();
    tiles_sum = json.at("tiles_checksum").get<std::uint64_t>();
  } catch (const Json::exception&) {
    throw damaged;
  }
  const std::uint64_t left = bytes.size() - kPreamble - size;
  if (!is_sound(camera) ||
      tiles != static_cast<std::uint64_t>(Film(camera.window, 1, 1).tile_count()))
    throw damaged;
  if (tiles > left / sizeof(CompiledTile) || groups > left / sizeof(CompiledGroup) ||
      nodes > left / sizeof(CompiledNode))
    throw cut_off;
  const std::uint64_t wanted =
      tiles * sizeof(CompiledTile) + groups * sizeof(CompiledGroup) + nodes * sizeof(CompiledNode);
  if (left < wanted) throw cut_off;
  if (left > wanted) throw damaged;
  const std::size_t first = kPreamble + static_cast<std::size_t>(size);
  camera.tiles = items_at<CompiledTile>(bytes, first, tiles);
  camera.groups = items_at<CompiledGroup>(bytes, first + camera.tiles.size_bytes(), groups);
  camera.nodes = items_at<CompiledNode>(
      bytes, first + camera.tiles.size_bytes() + camera.groups.size_bytes(), nodes);
  if (crc(0, bytes_of(camera.tiles)) != tiles_sum || !are_in_order(camera)) throw damaged;
  camera.memory = file;
  return camera;
}

}  // namespace plenoflame
