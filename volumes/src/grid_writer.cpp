#include "plenoflame/volumes/grid_writer.h"

#include <fmt/format.h>
#include <openvdb/io/Archive.h>
#include <openvdb/openvdb.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <ostream>
#include <utility>

#include "field.h"
#include "plenoflame/base/error.h"
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

/// A file under a temporary name that disappears unless it is renamed.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& target)
      : path_(fmt::format("{}.{}.partial", target, getpid())) {}
  ~TemporaryFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// Every brick comes as some bytes of its own.
class StoppableFile : public std::filebuf {
 public:
  explicit StoppableFile(std::stop_token stop) : stop_(std::move(stop)) {}

 protected:
  std::streamsize xsputn(const char* bytes, std::streamsize count) override {
    if (stop_.stop_requested()) throw Cancelled();
    return std::filebuf::xsputn(bytes, count);
  }

 private:
  std::stop_token stop_;
};

[[noreturn]] void fail(const std::string& path, const std::string& cause) {
  throw FileError(fmt::format("{}: cannot be written: {}", path, cause));
}

std::string system_cause() {
  return errno != 0 ? std::strerror(errno) : "write error";
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
                      "write it without --half",
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
  const TemporaryFile temporary(path);
  errno = 0;
  StoppableFile file(options.stop);
  if (!file.open(temporary.path(), std::ios::out | std::ios::binary | std::ios::trunc))
    fail(path, system_cause());
  try {
    std::ostream stream(&file);
    stream.exceptions(std::ios::failbit | std::ios::badbit);
    Writer(options.compression).write_file(stream, converted, metadata);
    if (!file.close()) fail(path, system_cause());
  } catch (const std::ios_base::failure&) {
    fail(path, system_cause());
  } catch (const openvdb::Exception& failure) {
    fail(path, failure.what());
  }
  const auto size = std::filesystem::file_size(temporary.path(), error);
  if (error) fail(path, error.message());
  std::filesystem::rename(temporary.path(), path, error);
  if (error) fail(path, error.message());
  return size;
}

}  // namespace plenoflame
