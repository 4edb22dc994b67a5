#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <istream>
#include <stdexcept>
#include <streambuf>
#include <string>
#include <vector>

namespace plenoflame::detail {

/// The bytes do not follow the format. Turned into a FileError where the file's name is known.
struct Damaged : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// @throws FileError naming the path.
std::vector<char> read_bytes(const std::string& path);

/// Reads little-endian values from bytes in memory; never leaves them.
class ByteReader {
 public:
  ByteReader(const char* data, std::size_t size) : data_(data), size_(size) {}

  std::size_t position() const { return position_; }
  std::size_t remaining() const { return size_ - position_; }
  void seek(std::size_t position) {
    if (position > size_) throw Damaged("it ends too early");
    position_ = position;
  }
  const char* take(std::size_t count) {
    if (count > remaining()) throw Damaged("it ends too early");
    const char* bytes = data_ + position_;
    position_ += count;
    return bytes;
  }
  template <class T>
  T value() {
    T result;
    std::memcpy(&result, take(sizeof(T)), sizeof(T));
    return result;
  }
  /// Length in 32 bits, then the characters.
  std::string text() {
    const auto length = value<std::uint32_t>();
    const char* characters = take(length);
    return {characters, length};
  }

 private:
  const char* data_;
  std::size_t size_;
  std::size_t position_ = 0;
};

/// Hands out bytes in memory, all or none of the requested number.
class MemoryBuffer : public std::streambuf {
 public:
  MemoryBuffer(const char* data, std::size_t size);

 private:
  std::streamsize xsgetn(char* target, std::streamsize count) override;
  pos_type seekoff(off_type offset, std::ios_base::seekdir direction,
                   std::ios_base::openmode which) override;
  pos_type seekpos(pos_type position, std::ios_base::openmode which) override;
};

/// Stream over bytes in memory that throws std::ios_base::failure at any failure.
class MemoryStream : private MemoryBuffer, public std::istream {
 public:
  MemoryStream(const char* data, std::size_t size);
};

}  // namespace plenoflame::detail
