#include "image/tiff_pages.h"

#include <tiffio.h>

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <memory>

#include "plenoflame/base/error.h"
#include "plenoflame/base/printable.h"

namespace plenoflame {
namespace {

/// A file that is read from memory, and libtiff's last complaint about it.
struct TiffSource {
  const std::string* bytes = nullptr;
  std::uint64_t at = 0;
  std::string complaint;
};

TiffSource& source_of(thandle_t handle) {
  return *static_cast<TiffSource*>(handle);
}

tmsize_t tiff_read(thandle_t handle, void* to, tmsize_t count) {
  TiffSource& source = source_of(handle);
  const std::uint64_t size = source.bytes->size();
  const std::uint64_t left = size - std::min(source.at, size);
  const std::uint64_t part =
      std::min(left, static_cast<std::uint64_t>(std::max<tmsize_t>(count, 0)));
  if (part > 0) std::memcpy(to, source.bytes->data() + source.at, part);
  source.at += part;
  return static_cast<tmsize_t>(part);
}

tmsize_t tiff_write(thandle_t, void*, tmsize_t) {
  return 0;
}

toff_t tiff_seek(thandle_t handle, toff_t offset, int whence) {
  TiffSource& source = source_of(handle);
  const toff_t base = whence == SEEK_SET   ? 0
                      : whence == SEEK_CUR ? source.at
                                           : static_cast<toff_t>(source.bytes->size());
  source.at = base + offset;
  return source.at;
}

int tiff_close(thandle_t) {
  return 0;
}

toff_t tiff_size(thandle_t handle) {
  return static_cast<toff_t>(source_of(handle).bytes->size());
}

int keep_complaint(TIFF*, void* user, const char*, const char* format, va_list values) {
  char text[300];
  static_cast<void>(std::vsnprintf(text, sizeof text, format, values));
  auto& complaint = static_cast<TiffSource*>(user)->complaint;
  if (complaint.empty()) complaint = printable(text);
  return 1;
}

int drop_warning(TIFF*, void*, const char*, const char*, va_list) {
  return 1;  // harmless oddities of other writers
}

/// Takes numbers of `bits` bits out of a row of bytes, the highest bit first. Numbers of 16 bits
/// are in the machine's order, as libtiff returns them.
void unpack_row(const unsigned char* row, int bits, std::size_t count, std::uint16_t* out) {
  if (bits == 16) {
    std::memcpy(out, row, 2 * count);
    return;
  }
  if (bits == 8) {
    std::copy_n(row, count, out);
    return;
  }
  std::uint32_t held = 0;
  int have = 0;
  for (std::size_t i = 0; i < count; ++i) {
    while (have < bits) {
      held = held << 8 | *row++;
      have += 8;
    }
    have -= bits;
    out[i] = static_cast<std::uint16_t>(held >> have & ((1U << bits) - 1));
  }
}

class TiffPageReader {
 public:
  TiffPageReader(const std::string& path, TiffSource& source, TIFF* tiff)
      : path_(path), source_(source), tiff_(tiff) {}

  RawPicture read() {
    const RawPicture& picture = header();
    picture_.samples.resize(picture.pixel_count() * static_cast<std::size_t>(picture.channels));
    if (TIFFIsTiled(tiff_) != 0)
      read_tiles();
    else
      read_strips();
    if (inverted_)
      for (std::uint16_t& sample : picture_.samples)
        sample = static_cast<std::uint16_t>(((1U << picture_.bits) - 1) - sample);
    return std::move(picture_);
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    throw FileError("cannot read '" + path_ + "': " + why);
  }
  [[noreturn]] void damaged() const {
    fail("damaged TIFF, or cut off" +
         (source_.complaint.empty() ? std::string() : " (" + source_.complaint + ")"));
  }

  const RawPicture& header() {
    std::uint32_t width = 0, height = 0;
    std::uint16_t bits = 1, per_pixel = 1, format = SAMPLEFORMAT_UINT, planar = 1, packing = 1;
    std::uint16_t meaning = PHOTOMETRIC_MINISBLACK, orientation = ORIENTATION_TOPLEFT;
    if (TIFFGetField(tiff_, TIFFTAG_IMAGEWIDTH, &width) != 1 ||
        TIFFGetField(tiff_, TIFFTAG_IMAGELENGTH, &height) != 1)
      damaged();
    TIFFGetFieldDefaulted(tiff_, TIFFTAG_BITSPERSAMPLE, &bits);
    TIFFGetFieldDefaulted(tiff_, TIFFTAG_SAMPLESPERPIXEL, &per_pixel);
    TIFFGetFieldDefaulted(tiff_, TIFFTAG_SAMPLEFORMAT, &format);
    TIFFGetFieldDefaulted(tiff_, TIFFTAG_PLANARCONFIG, &planar);
    TIFFGetFieldDefaulted(tiff_, TIFFTAG_COMPRESSION, &packing);
    TIFFGetFieldDefaulted(tiff_, TIFFTAG_ORIENTATION, &orientation);
    TIFFGetField(tiff_, TIFFTAG_PHOTOMETRIC, &meaning);
    if (format != SAMPLEFORMAT_UINT && format != SAMPLEFORMAT_VOID)
      fail(
          "a TIFF of floating-point or signed numbers is no raw picture; save the camera's whole "
          "numbers");
    if (bits < 1 || bits > 16)
      fail("a TIFF of " + std::to_string(bits) + " bits per number; 1 to 16 are read");
    const bool colour = meaning == PHOTOMETRIC_RGB;
    constexpr std::uint16_t kLinearRaw = 34892;  // DNG
    if (!colour && meaning != PHOTOMETRIC_MINISBLACK && meaning != PHOTOMETRIC_MINISWHITE &&
        meaning != PHOTOMETRIC_CFA && meaning != kLinearRaw)
      fail("a TIFF of palettes, YCbCr or printing colours is no raw picture; save it grey or RGB");
    if (per_pixel < (colour ? 3 : 1) || per_pixel > 16)
      fail("a TIFF with " + std::to_string(per_pixel) + " numbers per pixel");
    if (orientation != ORIENTATION_TOPLEFT)
      fail("the TIFF asks to be turned or mirrored (tag Orientation " +
           std::to_string(orientation) + "); save it with rows from the top left");
    if (TIFFIsCODECConfigured(packing) == 0)
      fail("the TIFF is packed in a way that is not read here (compression " +
           std::to_string(packing) + "); save it unpacked, or with LZW or Deflate");
    constexpr std::uint64_t kMostPixels = 1000000000;
    const std::uint64_t pixels = std::uint64_t{width} * height;
    if (width == 0 || height == 0 || pixels > kMostPixels) damaged();
    planar_ = planar == PLANARCONFIG_SEPARATE;
    per_pixel_ = per_pixel;
    // A stated size is believed as far as the file can hold it: Deflate packs at most 1032 to 1,
    // LZW 1365 to 1; others less.
    const std::uint64_t bytes = pixels * per_pixel * bits / 8;
    const std::uint64_t most = packing == COMPRESSION_NONE ? 1 : 1500;
    if (bytes / most > source_.bytes->size()) fail("the TIFF is too short for its size: cut off");
    picture_.kind = "TIFF";
    picture_.width = static_cast<int>(width);
    picture_.height = static_cast<int>(height);
    picture_.channels = colour ? 3 : 1;
    picture_.bits = bits;
    picture_.lossy = packing == COMPRESSION_JPEG || packing == COMPRESSION_OJPEG;
    inverted_ = meaning == PHOTOMETRIC_MINISWHITE;
    return picture_;
  }

  /// Buffer for a strip or tile, whose size libtiff states. It cannot be larger than a few rows
  /// more than the picture.
  std::vector<unsigned char> buffer(tmsize_t size, std::uint64_t rows,
                                    std::uint64_t columns) const {
    const std::uint64_t most =
        (columns * static_cast<std::uint64_t>(per_pixel_) * 2 + 16) * (rows + 16);
    if (size <= 0 || static_cast<std::uint64_t>(size) > most) damaged();
    return std::vector<unsigned char>(static_cast<std::size_t>(size));
  }

  /// Channels that one strip or tile holds side by side.
  int together() const { return planar_ ? 1 : per_pixel_; }

  /// Puts one row of a strip or tile into the picture. @param plane of a planar file
  void put(const unsigned char* bytes, int row, int column, int count, int plane) {
    const auto numbers = static_cast<std::size_t>(count * together());
    line_.resize(numbers);
    unpack_row(bytes, picture_.bits, numbers, line_.data());
    const int channels = picture_.channels;
    std::uint16_t* to = picture_.samples.data() +
                        (static_cast<std::size_t>(row) * static_cast<std::size_t>(picture_.width) +
                         static_cast<std::size_t>(column)) *
                            static_cast<std::size_t>(channels);
    for (int i = 0; i < count; ++i)
      if (planar_)
        to[i * channels + plane] = line_[static_cast<std::size_t>(i)];
      else
        for (int c = 0; c < channels; ++c)
          to[i * channels + c] = line_[static_cast<std::size_t>(i * per_pixel_ + c)];
  }

  void read_strips() {
    std::uint32_t rows = 0;
    TIFFGetFieldDefaulted(tiff_, TIFFTAG_ROWSPERSTRIP, &rows);
    if (rows == 0) damaged();
    const int per_strip = static_cast<int>(
        std::min<std::uint64_t>(rows, static_cast<std::uint64_t>(picture_.height)));
    const tmsize_t line = TIFFScanlineSize(tiff_);
    const auto numbers = static_cast<std::uint64_t>(picture_.width * together());
    if (line <= 0 || static_cast<std::uint64_t>(line) <
                         (numbers * static_cast<std::uint64_t>(picture_.bits) + 7) / 8)
      damaged();
    std::vector<unsigned char> bytes =
        buffer(TIFFStripSize(tiff_), static_cast<std::uint64_t>(per_strip),
               static_cast<std::uint64_t>(picture_.width));
    for (int plane = 0; plane < (planar_ ? picture_.channels : 1); ++plane)
      for (int row = 0; row < picture_.height; row += per_strip) {
        const std::uint32_t strip = TIFFComputeStrip(tiff_, static_cast<std::uint32_t>(row),
                                                     static_cast<std::uint16_t>(plane));
        const int count = std::min(per_strip, picture_.height - row);
        const tmsize_t wanted = line * count;
        if (static_cast<std::size_t>(wanted) > bytes.size() ||
            TIFFReadEncodedStrip(tiff_, strip, bytes.data(), wanted) != wanted)
          damaged();
        for (int i = 0; i < count; ++i)
          put(bytes.data() + static_cast<std::size_t>(line) * static_cast<std::size_t>(i), row + i,
              0, picture_.width, plane);
      }
  }

  void read_tiles() {
    std::uint32_t width = 0, height = 0;
    if (TIFFGetField(tiff_, TIFFTAG_TILEWIDTH, &width) != 1 ||
        TIFFGetField(tiff_, TIFFTAG_TILELENGTH, &height) != 1 || width == 0 || height == 0 ||
        width > 1U << 20 || height > 1U << 20)
      damaged();
    const tmsize_t line = TIFFTileRowSize(tiff_);
    const tmsize_t size = TIFFTileSize(tiff_);
    const std::uint64_t numbers = std::uint64_t{width} * static_cast<std::uint64_t>(together());
    if (line <= 0 ||
        static_cast<std::uint64_t>(line) <
            (numbers * static_cast<std::uint64_t>(picture_.bits) + 7) / 8 ||
        size < line * static_cast<tmsize_t>(height) ||
        // A tile that packs well may be larger than the file, but not by more than packing does.
        static_cast<std::uint64_t>(size) / 1500 > source_.bytes->size())
      damaged();
    std::vector<unsigned char> bytes = buffer(size, height, width);
    const int step_x = static_cast<int>(width), step_y = static_cast<int>(height);
    for (int plane = 0; plane < (planar_ ? picture_.channels : 1); ++plane)
      for (int row = 0; row < picture_.height; row += step_y)
        for (int column = 0; column < picture_.width; column += step_x) {
          const std::uint32_t tile = TIFFComputeTile(tiff_, static_cast<std::uint32_t>(column),
                                                     static_cast<std::uint32_t>(row), 0,
                                                     static_cast<std::uint16_t>(plane));
          if (TIFFReadEncodedTile(tiff_, tile, bytes.data(), size) != size) damaged();
          const int rows = std::min(step_y, picture_.height - row);
          const int columns = std::min(step_x, picture_.width - column);
          for (int i = 0; i < rows; ++i)
            put(bytes.data() + static_cast<std::size_t>(line) * static_cast<std::size_t>(i),
                row + i, column, columns, plane);
        }
  }

  const std::string& path_;
  TiffSource& source_;
  TIFF* tiff_;
  RawPicture picture_;
  bool planar_ = false, inverted_ = false;
  int per_pixel_ = 1;
  std::vector<std::uint16_t> line_;
};

}  // namespace

void read_tiff_pages(const std::string& path, const std::string& bytes,
                     const std::function<void(RawPicture&&)>& take) {
  TiffSource source{&bytes, 0, {}};
  const std::unique_ptr<TIFFOpenOptions, decltype(&TIFFOpenOptionsFree)> options(
      TIFFOpenOptionsAlloc(), &TIFFOpenOptionsFree);
  if (!options) throw std::bad_alloc();
  TIFFOpenOptionsSetErrorHandlerExtR(options.get(), keep_complaint, &source);
  TIFFOpenOptionsSetWarningHandlerExtR(options.get(), drop_warning, nullptr);
  constexpr tmsize_t kLargestPart = tmsize_t{1} << 31;
  TIFFOpenOptionsSetMaxSingleMemAlloc(
      options.get(),
      std::clamp<tmsize_t>(static_cast<tmsize_t>(bytes.size()) * 64, 1 << 20, kLargestPart));
  const std::unique_ptr<TIFF, decltype(&TIFFClose)> tiff(
      TIFFClientOpenExt(path.c_str(), "rm", &source, tiff_read, tiff_write, tiff_seek, tiff_close,
                        tiff_size, nullptr, nullptr, options.get()),
      &TIFFClose);
  if (!tiff)
    throw FileError("cannot read '" + path + "': damaged TIFF, or cut off" +
                    (source.complaint.empty() ? "" : " (" + source.complaint + ")"));
  int width = 0, height = 0, page = 0;
  do {
    RawPicture picture = TiffPageReader(path, source, tiff.get()).read();
    ++page;
    if (page > 1 && (picture.width != width || picture.height != height))
      throw FileError("cannot read '" + path + "': page " + std::to_string(page) + " has " +
                      std::to_string(picture.width) + " x " + std::to_string(picture.height) +
                      " pixels, the first " + std::to_string(width) + " x " +
                      std::to_string(height) + "; pages are frames of one series");
    width = picture.width;
    height = picture.height;
    take(std::move(picture));
    source.complaint.clear();
  } while (TIFFReadDirectory(tiff.get()) == 1);
  // A directory that cannot be read ends the pages as the last one does, but with a complaint.
  if (!source.complaint.empty())
    throw FileError("cannot read '" + path + "': damaged TIFF after page " + std::to_string(page) +
                    " (" + source.complaint + ")");
}

}  // namespace plenoflame
