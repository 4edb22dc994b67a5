#include <zlib.h>

#include <bit>
#include <limits>

#include "lightfield/export/array_files.h"
#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

static_assert(std::endian::native == std::endian::little, "npy headers say little endian");

void append(std::string& bytes, std::uint64_t value, int count) {
  for (int i = 0; i < count; ++i) bytes.push_back(static_cast<char>(value >> (8 * i) & 0xff));
}

/// The header before the data of a .npy file.
std::string npy_header(const std::string& kind, const std::string& shape) {
  std::string header =
      "{'descr': '" + kind + "', 'fortran_order': False, 'shape': " + shape + ", }";
  // Magic, version and length take 10 bytes; the data start at a multiple of 64.
  header.append(63 - (10 + header.size()) % 64, ' ').push_back('\n');
  std::string bytes("\x93NUMPY\x01\x00", 8);
  append(bytes, header.size(), 2);
  return bytes + header;
}

std::string npy_bytes(const NamedArray& array) {
  std::string shape = "(";
  for (const std::size_t n : array.shape) shape += std::to_string(n) + ",";
  shape += ")";
  return std::visit(
      [&shape](const auto& values) {
        using Value = typename std::decay_t<decltype(values)>::value_type;
        const char* kind = std::is_same_v<Value, float>          ? "<f4"
                           : std::is_same_v<Value, double>       ? "<f8"
                           : std::is_same_v<Value, std::int64_t> ? "<i8"
                           : std::is_same_v<Value, std::int16_t> ? "<i2"
                           : std::is_same_v<Value, std::int8_t>  ? "|i1"
                                                                 : "<i4";
        std::string bytes = npy_header(kind, shape);
        bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value));
        return bytes;
      },
      array.values);
}

/// The fields that a file's local and its central record have in common.
std::string common_record(std::uint32_t checksum, std::size_t size, const std::string& name) {
  std::string bytes;
  append(bytes, 20, 2);      // version needed
  append(bytes, 0, 2);       // flags
  append(bytes, 0, 2);       // stored
  append(bytes, 0, 2);       // time
  append(bytes, 0x0021, 2);  // date: 1980-01-01, so that equal arrays give equal files
  append(bytes, checksum, 4);
  append(bytes, size, 4);
  append(bytes, size, 4);
  append(bytes, name.size(), 2);
  append(bytes, 0, 2);  // extra field
  return bytes;
}

}  // namespace

std::string npz_bytes(const std::vector<NamedArray>& arrays,
                      const std::vector<std::pair<std::string, std::string>>& texts) {
  std::string bytes, directory;
  const auto add = [&](const std::string& name, const std::string& file) {
    const std::uint64_t offset = bytes.size();
    if (offset + file.size() > std::numeric_limits<std::uint32_t>::max() - 65536)
      throw InputError(
          "the arrays take more than the 4 GiB of an npz file; choose another format, or less of "
          "them");
    const auto checksum = static_cast<std::uint32_t>(
        crc32_z(0, reinterpret_cast<const Bytef*>(file.data()), file.size()));
    const std::string common = common_record(checksum, file.size(), name);
    append(bytes, 0x04034b50, 4);
    bytes += common + name + file;
    append(directory, 0x02014b50, 4);
    append(directory, 20, 2);  // version made by
    directory += common;
    append(directory, 0, 2);  // comment
    append(directory, 0, 2);  // disk
    append(directory, 0, 2);  // internal attributes
    append(directory, 0, 4);  // external attributes
    append(directory, offset, 4);
    directory += name;
  };
  for (const NamedArray& array : arrays) add(array.name + ".npy", npy_bytes(array));
  for (const auto& [name, text] : texts)
    add(name + ".npy", npy_header("|S" + std::to_string(text.size()), "()") + text);
  const std::uint64_t start = bytes.size();
  bytes += directory;
  append(bytes, 0x06054b50, 4);
  append(bytes, 0, 4);  // disks
  append(bytes, arrays.size() + texts.size(), 2);
  append(bytes, arrays.size() + texts.size(), 2);
  append(bytes, directory.size(), 4);
  append(bytes, start, 4);
  append(bytes, 0, 2);  // comment
  return bytes;
}

}  // namespace plenoflame
