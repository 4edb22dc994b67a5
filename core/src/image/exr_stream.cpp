#include "exr_stream.h"

#include <Iex.h>
#include <sys/stat.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "plenoflame/base/error.h"
#include "plenoflame/image/open_file.h"

namespace plenoflame {
namespace {

std::uint32_t little_endian(const std::array<unsigned char, 4>& bytes) {
  return bytes[0] | static_cast<std::uint32_t>(bytes[1]) << 8 |
         static_cast<std::uint32_t>(bytes[2]) << 16 | static_cast<std::uint32_t>(bytes[3]) << 24;
}

}  // namespace

void ExrOutput::write(const char c[], int n) {
  const auto count = static_cast<std::size_t>(n);
  if (std::fwrite(c, 1, count, file_.stream()) == count) return;
  if (error_ == 0) error_ = errno;
  throw Iex::IoExc("write failed");
}

void ExrOutput::seekp(std::uint64_t position) {
  if (fseeko(file_.stream(), static_cast<off_t>(position), SEEK_SET) == 0) return;
  if (error_ == 0) error_ = errno;
  throw Iex::IoExc("seek failed");
}

ExrInput::ExrInput(const std::string& path)
    : Imf::IStream(path.c_str()), path_(path), file_(open_for_reading(path)) {
  struct stat status {};
  if (!file_ || fstat(fileno(file_.get()), &status) != 0)
    throw FileError("cannot read '" + path + "': " + std::strerror(errno));
  if (!S_ISREG(status.st_mode))
    throw FileError("cannot read '" + path + "': it is not a regular file");
  size_ = static_cast<std::uint64_t>(status.st_size);
}

bool ExrInput::read(char c[], int n) {
  if (n < 0 ||
      std::fread(c, 1, static_cast<std::size_t>(n), file_.get()) != static_cast<std::size_t>(n))
    throw Iex::InputExc("unexpected end of file");
  return tellg() < size_;
}

void ExrInput::seekg(std::uint64_t position) {
  if (position > size_ || fseeko(file_.get(), static_cast<off_t>(position), SEEK_SET) != 0)
    throw Iex::InputExc("position beyond the end of the file");
}

std::string ExrInput::read_name() {
  std::string name;
  for (int c = std::fgetc(file_.get()); c > 0 && name.size() < 256; c = std::fgetc(file_.get()))
    name += static_cast<char>(c);
  return name;
}

void ExrInput::check_header() {
  std::array<unsigned char, 4> word{};
  const auto next_word = [&] { return std::fread(word.data(), 1, 4, file_.get()) == 4; };
  constexpr std::uint32_t kMagic = 20000630;
  if (!next_word() || little_endian(word) != kMagic || !next_word())
    throw FileError("cannot read '" + path_ + "': not an EXR file");
  constexpr std::uint32_t kVersion = 2, kLongNames = 0x400;
  if ((little_endian(word) & ~kLongNames) != kVersion)
    throw InputError("'" + path_ +
                     "' is not a light field of Plenoflame: it is a tiled, deep or multi-part EXR");
  for (;;) {
    const std::string name = read_name();
    if (name.empty()) break;
    const std::string type = read_name();
    if (type.empty() || !next_word()) break;  // OpenEXR reports the rest
    const std::uint32_t length = little_endian(word);
    if (length > size_ - tellg())
      throw FileError("cannot read '" + path_ +
                      "': damaged EXR (an attribute is longer "
                      "than the file)");
    seekg(tellg() + length);
  }
  clear();
  seekg(0);
}

}  // namespace plenoflame
