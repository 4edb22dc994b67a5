#include "plenoflame/image/tiff_file.h"

#include <tiffio.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <string_view>

#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"

namespace plenoflame {
namespace {

/// A file in memory: libtiff goes back to write its directory.
struct Memory {
  std::string bytes;
  std::size_t at = 0;
};

Memory& memory_of(thandle_t handle) {
  return *static_cast<Memory*>(handle);
}

tmsize_t read_bytes(thandle_t handle, void* to, tmsize_t count) {
  Memory& memory = memory_of(handle);
  const std::size_t left = memory.bytes.size() - std::min(memory.at, memory.bytes.size());
  const std::size_t part = std::min(left, static_cast<std::size_t>(count));
  std::memcpy(to, memory.bytes.data() + memory.at, part);
  memory.at += part;
  return static_cast<tmsize_t>(part);
}

tmsize_t write_bytes(thandle_t handle, void* from, tmsize_t count) {
  Memory& memory = memory_of(handle);
  const auto size = static_cast<std::size_t>(count);
  if (memory.bytes.size() < memory.at + size) memory.bytes.resize(memory.at + size);
  std::memcpy(memory.bytes.data() + memory.at, from, size);
  memory.at += size;
  return count;
}

toff_t seek(thandle_t handle, toff_t offset, int whence) {
  Memory& memory = memory_of(handle);
  const toff_t base = whence == SEEK_SET   ? 0
                      : whence == SEEK_CUR ? static_cast<toff_t>(memory.at)
                                           : static_cast<toff_t>(memory.bytes.size());
  memory.at = static_cast<std::size_t>(base + offset);
  return static_cast<toff_t>(memory.at);
}

int close_nothing(thandle_t) {
  return 0;
}

toff_t size_of(thandle_t handle) {
  return static_cast<toff_t>(memory_of(handle).bytes.size());
}

}  // namespace

void write_tiff(const std::string& path, int width, int height,
                const std::vector<std::uint16_t>& samples, const std::string& description) {
  if (width < 1 || height < 1 ||
      samples.size() != static_cast<std::size_t>(width) * static_cast<std::size_t>(height))
    throw InputError("a TIFF needs as many samples as it has pixels");
  Memory memory;
  bool good = true;
  {
    const std::unique_ptr<TIFF, decltype(&TIFFClose)> tiff(
        TIFFClientOpen(path.c_str(), "w", &memory, read_bytes, write_bytes, seek, close_nothing,
                       size_of, nullptr, nullptr),
        &TIFFClose);
    if (!tiff) throw FileError("cannot write '" + path + "': libtiff does not start");
    const auto columns = static_cast<std::uint32_t>(width);
    good = TIFFSetField(tiff.get(), TIFFTAG_IMAGEWIDTH, columns) == 1 &&
           TIFFSetField(tiff.get(), TIFFTAG_IMAGELENGTH, static_cast<std::uint32_t>(height)) == 1 &&
           TIFFSetField(tiff.get(), TIFFTAG_BITSPERSAMPLE, 16) == 1 &&
           TIFFSetField(tiff.get(), TIFFTAG_SAMPLESPERPIXEL, 1) == 1 &&
           TIFFSetField(tiff.get(), TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT) == 1 &&
           TIFFSetField(tiff.get(), TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK) == 1 &&
           TIFFSetField(tiff.get(), TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG) == 1 &&
           TIFFSetField(tiff.get(), TIFFTAG_COMPRESSION, COMPRESSION_NONE) == 1 &&
           TIFFSetField(tiff.get(), TIFFTAG_ROWSPERSTRIP, 64) == 1 &&
           TIFFSetField(tiff.get(), TIFFTAG_IMAGEDESCRIPTION, description.c_str()) == 1;
    std::vector<std::uint16_t> line(static_cast<std::size_t>(width));
    for (int row = 0; good && row < height; ++row) {
      std::copy_n(samples.begin() + static_cast<std::ptrdiff_t>(row) * width, width, line.begin());
      good = TIFFWriteScanline(tiff.get(), line.data(), static_cast<std::uint32_t>(row), 0) == 1;
    }
    good = good && TIFFFlush(tiff.get()) == 1;
  }
  if (!good) throw FileError("cannot write '" + path + "': libtiff failed");
  write_file(path, memory.bytes);
}

}  // namespace plenoflame
