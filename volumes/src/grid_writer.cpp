#include "plenoflame/volumes/grid_writer.h"

#include <fmt/format.h>
#include <openvdb/io/Archive.h>
#include <openvdb/openvdb.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <ostream>
#include <streambuf>
#include <utility>

#include "field.h"
#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/volumes/interop.h"

namespace plenoflame {
namespace {

constexpr float kLargestHalf = 65504;

/// OpenVDB's own file class does not report every failed write; this one writes to a stream that
/// does.
class Writer : public openvdb::io::Archive {
 public:
  explicit Writer(VdbCompression compression) {
    std::uint32_t flags = openvdb::io::COMPRESS_ACTIVE_MASK;
    if (compression == VdbCompression::blosc)
      flags |= hasBloscCompression() ? openvdb::io::COMPRESS_BLOSC : openvdb::io::COMPRESS_ZIP;
    if (compression == VdbCompression::zip) flags |= openvdb::io::COMPRESS_ZIP;
    setCompression(flags);
  }
  void write_file(std::ostream& stream, const openvdb::GridPtrVec& grids,
                  const openvdb::MetaMap& metadata) {
    setInputHasGridOffsets(true);
    Archive::write(stream, grids, /*seekable=*/true, metadata);
  }
};

/// Place of a .vdb file's UUID, after the magic number, three versions and a flag.
constexpr std::int64_t kUuidBegin = 21, kUuidEnd = kUuidBegin + 36;

/// FNV-1a of 64 bits.
class Hash {
 public:
  explicit Hash(std::uint64_t seed) : value_(seed) {}
  void add(char byte) { value_ = (value_ ^ static_cast<unsigned char>(byte)) * 0x100000001b3U; }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_;
};

/// The stream to which OpenVDB writes. Its file appears when it is complete; a killed process
/// leaves no file. Every brick arrives as separate bytes, and writing can be stopped at each of
/// them.
class StoppableFile : public std::streambuf {
 public:
  StoppableFile(AtomicFile& file, std::stop_token stop) : file_(file), stop_(std::move(stop)) {}

 protected:
  std::streamsize xsputn(const char* bytes, std::streamsize count) override {
    if (stop_.stop_requested()) throw Cancelled();
    file_.write({bytes, static_cast<std::size_t>(count)});
    for (std::streamsize i = 0; i < count; ++i, ++place_) {
      if (place_ >= kUuidBegin && place_ < kUuidEnd) continue;
      for (Hash& hash : hashes_) hash.add(bytes[i]);
    }
    return count;
  }
  int_type overflow(int_type c) override {
    if (traits_type::eq_int_type(c, traits_type::eof())) return traits_type::not_eof(c);
    const char byte = traits_type::to_char_type(c);
    xsputn(&byte, 1);
    return c;
  }
  pos_type seekoff(off_type offset, std::ios::seekdir from, std::ios::openmode) override {
    const int whence = from == std::ios::beg   ? SEEK_SET
                       : from == std::ios::cur ? SEEK_CUR
                                               : SEEK_END;
    // Buffered bytes are written first, which may fail on a full disk.
    if (fseeko(file_.stream(), offset, whence) != 0) file_.fail(errno);
    place_ = ftello(file_.stream());
    return place_;
  }
  pos_type seekpos(pos_type place, std::ios::openmode which) override {
    return seekoff(off_type(place), std::ios::beg, which);
  }
  int sync() override {
    if (std::fflush(file_.stream()) != 0) file_.fail(errno);
    return 0;
  }

 public:
  /// Puts a UUID that follows from what was written in the place of OpenVDB's random one: equal
  /// grids make equal files.
  void settle_uuid() {
    const std::uint64_t a = hashes_[0].value(), b = hashes_[1].value();
    const std::string uuid =
        fmt::format("{:08x}-{:04x}-8{:03x}-a{:03x}-{:012x}", a >> 32, a >> 16 & 0xffff, a & 0xfff,
                    b >> 48 & 0xfff, b & 0xffffffffffff);  // version 8: of one's own making
    seekoff(kUuidBegin, std::ios::beg, std::ios::out);
    xsputn(uuid.data(), static_cast<std::streamsize>(uuid.size()));
  }

 private:
  AtomicFile& file_;
  std::stop_token stop_;
  std::int64_t place_ = 0;
  std::array<Hash, 2> hashes_{Hash(0xcbf29ce484222325U), Hash(0x9e3779b97f4a7c15U)};
};

[[noreturn]] void fail(const std::string& path, const std::string& cause) {
  throw FileError(fmt::format("{}: cannot be written: {}", path, cause));
}

}  // namespace

std::uint64_t write_grids(const std::string& path, std::span<const GridOutput> grids,
                          const GridWriteOptions& options) {
  openvdb::initialize();
  openvdb::GridPtrVec converted;
  for (const GridOutput& output : grids) {
    const VoxelField& field = *output.field;
    const auto range = detail::range(field);
    if (options.half && range && std::fmax(-range->minimum, range->maximum) > kLargestHalf)
      throw InputError(
          fmt::format("{}: grid \"{}\" has values up to {:g}, and 16 bits hold at most 65504; "
                      "write it in 32 bits",
                      path, field.name, std::fmax(-range->minimum, range->maximum)));
    if (options.stop.stop_requested()) throw Cancelled();
    const auto grid = to_openvdb(field);
    if (!output.unit.empty()) grid->insertMeta("unit", openvdb::StringMetadata(output.unit));
    for (const auto& [key, value] : output.metadata)
      grid->insertMeta(key, openvdb::StringMetadata(value));
    grid->setSaveFloatAsHalf(options.half);
    converted.push_back(grid);
  }
  openvdb::MetaMap metadata;
  for (const auto& [key, value] : options.metadata)
    metadata.insertMeta(key, openvdb::StringMetadata(value));

  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  std::error_code error;
  if (!folder.empty() && !std::filesystem::is_directory(folder, error))
    fail(path, fmt::format("there is no folder {}", folder.string()));
  if (std::filesystem::is_directory(path, error)) fail(path, "a folder has this name");
  AtomicFile file(path);
  StoppableFile buffer(file, options.stop);
  try {
    std::ostream stream(&buffer);
    stream.exceptions(std::ios::failbit | std::ios::badbit);
    Writer(options.compression).write_file(stream, converted, metadata);
    buffer.settle_uuid();
  } catch (const std::ios_base::failure&) {
    fail(path, "write error");
  } catch (const openvdb::Exception& failure) {
    fail(path, failure.what());
  }
  if (std::fseek(file.stream(), 0, SEEK_END) != 0) file.fail(errno);
  const auto size = static_cast<std::uint64_t>(ftello(file.stream()));
  file.commit();
  return size;
}

}  // namespace plenoflame
