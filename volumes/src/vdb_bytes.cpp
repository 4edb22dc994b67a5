#include "vdb_bytes.h"

#include <fmt/format.h>

#include <cerrno>
#include <filesystem>
#include <fstream>

#include "plenoflame/base/error.h"

namespace plenoflame::detail {

std::vector<char> read_bytes(const std::string& path) {
  errno = 0;
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    throw FileError(fmt::format("{}: is a folder, not a .vdb file", path));
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file)
    throw FileError(fmt::format("{}: cannot be opened ({})", path,
                                errno != 0 ? std::strerror(errno) : "unknown cause"));
  const std::streamoff size = file.tellg();
  if (size < 0) throw FileError(fmt::format("{}: cannot be read", path));
  std::vector<char> bytes(static_cast<std::size_t>(size));
  file.seekg(0);
  if (!file.read(bytes.data(), size)) throw FileError(fmt::format("{}: cannot be read", path));
  return bytes;
}

MemoryBuffer::MemoryBuffer(const char* data, std::size_t size) {
  // The buffer is only read; std::streambuf has no type for that.
  char* begin = const_cast<char*>(data);
  setg(begin, begin, begin + size);
}

MemoryStream::MemoryStream(const char* data, std::size_t size)
    : MemoryBuffer(data, size), std::istream(static_cast<MemoryBuffer*>(this)) {
  exceptions(std::ios_base::failbit | std::ios_base::badbit | std::ios_base::eofbit);
}

std::streamsize MemoryBuffer::xsgetn(char* target, std::streamsize count) {
  // Nothing is copied unless all of it is there: OpenVDB checks some lengths only afterwards.
  if (count < 0 || count > egptr() - gptr()) return 0;
  std::memcpy(target, gptr(), static_cast<std::size_t>(count));
  setg(eback(), gptr() + count, egptr());
  return count;
}

MemoryBuffer::pos_type MemoryBuffer::seekoff(off_type offset, std::ios_base::seekdir direction,
                                             std::ios_base::openmode) {
  const off_type size = egptr() - eback();
  off_type base = 0;
  if (direction == std::ios_base::cur) base = gptr() - eback();
  if (direction == std::ios_base::end) base = size;
  if (offset < -base || offset > size - base) return pos_type(off_type(-1));
  setg(eback(), eback() + base + offset, egptr());
  return pos_type(base + offset);
}

MemoryBuffer::pos_type MemoryBuffer::seekpos(pos_type position, std::ios_base::openmode which) {
  return seekoff(off_type(position), std::ios_base::beg, which);
}

}  // namespace plenoflame::detail
