#include "plenoflame/image/png_file.h"

#include <png.h>

#include <algorithm>
#include <cerrno>
#include <csetjmp>
#include <cstring>
#include <memory>
#include <span>
#include <string_view>

#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/image/open_file.h"

namespace plenoflame {
namespace {

// libpng reports errors by longjmp, which must not pass objects with destructors. The functions
// between setjmp and libpng therefore hold plain values only; everything else lives in their
// callers.

struct Failure {
  char message[200] = "";
};

void on_error(png_structp png, png_const_charp message) {
  auto* failure = static_cast<Failure*>(png_get_error_ptr(png));
  std::strncpy(failure->message, message, sizeof failure->message - 1);
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}  // harmless oddities of other writers

std::size_t row_bytes(const PngImage& image) {
  return static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.channels) *
         (image.bits == 16 ? 2 : 1);
}

/// Samples as PNG stores them: big-endian.
void pack_row(const PngImage& image, int row, png_byte* out) {
  const std::size_t count =
      static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.channels);
  const std::uint16_t* in = image.samples.data() + static_cast<std::size_t>(row) * count;
  for (std::size_t i = 0; i < count; ++i) {
    if (image.bits == 16) *out++ = static_cast<png_byte>(in[i] >> 8);
    *out++ = static_cast<png_byte>(in[i] & 0xff);
  }
}

/// @param buffer of a row @return false when libpng reported an error, or a stop was requested
bool write_rows(png_structp png, png_infop info, const PngImage& image,
                std::span<const png_text> texts, png_byte* buffer, const std::stop_token& stop) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_set_IHDR(png, info, static_cast<png_uint_32>(image.width),
               static_cast<png_uint_32>(image.height), image.bits,
               image.channels == 3 ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  if (image.transfer == Transfer::srgb)
    png_set_sRGB_gAMA_and_cHRM(png, info, PNG_sRGB_INTENT_RELATIVE);
  else
    png_set_gAMA_fixed(png, info, PNG_FP_1);
  if (image.significant_bits > 0) {
    const auto bits = static_cast<png_byte>(image.significant_bits);
    png_color_8 significant{};
    significant.red = significant.green = significant.blue = significant.gray = bits;
    png_set_sBIT(png, info, &significant);
  }
  if (!texts.empty()) png_set_text(png, info, texts.data(), static_cast<int>(texts.size()));
  // Level 3 takes a third of the time of the default for a few per cent more bytes.
  png_set_compression_level(png, 3);
  png_write_info(png, info);
  for (int row = 0; row < image.height; ++row) {
    if (stop.stop_requested()) return false;
    pack_row(image, row, buffer);
    png_write_row(png, buffer);
  }
  png_write_end(png, info);
  return true;
}

struct ReadHeader {
  png_uint_32 width = 0, height = 0;
  int bits = 0, channels = 0, significant_bits = 0, text_count = 0;
  int stored_bits = 0;  ///< of a pixel in the file, which may be fewer than are read
  bool linear = false;
  png_textp texts = nullptr;
};

bool read_header(png_structp png, png_infop info, std::FILE* stream, ReadHeader& header) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_init_io(png, stream);
  png_read_info(png, info);
  header.stored_bits = png_get_bit_depth(png, info) * png_get_channels(png, info);
  png_set_expand(png);
  png_set_strip_alpha(png);
  png_set_interlace_handling(png);
  png_color_8p significant = nullptr;
  if (png_get_sBIT(png, info, &significant) != 0)
    header.significant_bits = (png_get_color_type(png, info) & PNG_COLOR_MASK_COLOR) != 0
                                  ? significant->green
                                  : significant->gray;
  png_fixed_point gamma = 0;
  header.linear = png_get_gAMA_fixed(png, info, &gamma) != 0 && gamma == PNG_FP_1;
  png_read_update_info(png, info);
  header.width = png_get_image_width(png, info);
  header.height = png_get_image_height(png, info);
  header.bits = png_get_bit_depth(png, info);
  header.channels = png_get_channels(png, info);
  png_get_text(png, info, &header.texts, &header.text_count);
  return true;
}

bool read_rows(png_structp png, png_infop info, png_bytep* rows) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_read_image(png, rows);
  png_read_end(png, info);
  return true;
}

void check(const PngImage& image) {
  if (image.width <= 0 || image.height <= 0 || (image.channels != 1 && image.channels != 3) ||
      (image.bits != 8 && image.bits != 16))
    throw InputError("a PNG needs a positive size, 1 or 3 channels and 8 or 16 bits");
  if (image.samples.size() != image.sample_count())
    throw InputError("a PNG of " + std::to_string(image.width) + " x " +
                     std::to_string(image.height) + " pixels was given " +
                     std::to_string(image.samples.size()) + " samples");
  if (image.significant_bits < 0 || image.significant_bits > image.bits)
    throw InputError("significant bits must be between 0 and the bits per sample");
  if (image.bits == 8 && std::any_of(image.samples.begin(), image.samples.end(),
                                     [](std::uint16_t sample) { return sample > 255; }))
    throw InputError("a sample exceeds the 8 bits of the PNG");
  for (const auto& [keyword, text] : image.texts)
    if (keyword.empty() || keyword.size() > 79)
      throw InputError("a keyword in a PNG has 1 to 79 characters: '" + keyword + "'");
}

}  // namespace

void write_png(const std::string& path, const PngImage& image, const std::stop_token& stop) {
  check(image);
  std::vector<png_text> texts;
  for (const auto& [keyword, text] : image.texts) {
    png_text entry{};
    entry.compression = PNG_ITXT_COMPRESSION_NONE;
    entry.key = const_cast<png_charp>(keyword.c_str());
    entry.text = const_cast<png_charp>(text.c_str());
    entry.itxt_length = text.size();
    texts.push_back(entry);
  }
  AtomicFile file(path);
  Failure failure;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &failure, on_error, on_warning);
  if (png == nullptr) throw std::bad_alloc();
  png_infop info = png_create_info_struct(png);
  std::vector<png_byte> buffer(row_bytes(image));
  png_init_io(png, file.stream());
  errno = 0;
  const bool written = info != nullptr && write_rows(png, info, image, texts, buffer.data(), stop);
  const int error = errno;
  png_destroy_write_struct(&png, &info);
  if (!written) {
    if (stop.stop_requested()) throw Cancelled();
    if (std::ferror(file.stream()) != 0) file.fail(error);
    throw FileError("cannot write '" + path + "': " + failure.message);
  }
  file.commit();
}

PngImage read_png(const std::string& path) {
  struct Closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Closer> stream(open_for_reading(path));
  if (!stream) throw FileError("cannot read '" + path + "': " + std::strerror(errno));
  png_byte signature[8] = {};
  if (std::fread(signature, 1, sizeof signature, stream.get()) != sizeof signature ||
      png_sig_cmp(signature, 0, sizeof signature) != 0)
    throw FileError("cannot read '" + path + "': not a PNG file");
  std::fseek(stream.get(), 0, SEEK_END);
  const auto file_size = static_cast<std::uint64_t>(std::ftell(stream.get()));
  // libpng takes memory for what a chunk's header states before it reads the chunk.
  for (std::uint64_t at = sizeof signature; at + 12 <= file_size;) {
    png_byte length[4] = {};
    std::fseek(stream.get(), static_cast<long>(at), SEEK_SET);
    if (std::fread(length, 1, sizeof length, stream.get()) != sizeof length) break;
    at += 12 + std::uint64_t{png_get_uint_32(length)};
    if (at > file_size)
      throw FileError("cannot read '" + path + "': damaged PNG (it ends too early)");
  }
  std::rewind(stream.get());

  Failure failure;
  struct Reader {
    png_structp png = nullptr;
    png_infop info = nullptr;
    ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }
  } reader;
  reader.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &failure, on_error, on_warning);
  if (reader.png == nullptr) throw std::bad_alloc();
  reader.info = png_create_info_struct(reader.png);
  if (reader.info == nullptr) throw std::bad_alloc();

  // A chunk cannot be longer than the file; the lengths that it states are not believed. Texts
  // that are packed may grow to what libpng allows by itself.
  constexpr std::uint64_t kLeastChunk = 1 << 16, kMostChunk = 8000000;
  png_set_chunk_malloc_max(reader.png, std::clamp(file_size, kLeastChunk, kMostChunk));

  const auto damaged = [&](const std::string& what) {
    throw FileError("cannot read '" + path + "': damaged PNG (" + what + ")");
  };
  ReadHeader header;
  if (!read_header(reader.png, reader.info, stream.get(), header)) damaged(failure.message);
  // Deflate packs at most 1032 to 1: a larger claim is damage.
  const std::uint64_t bytes = std::uint64_t{header.width} * header.height *
                              static_cast<std::uint64_t>(header.stored_bits) / 8;
  if (bytes / 1032 > file_size) damaged("too short for its size");

  PngImage image;
  image.width = static_cast<int>(header.width);
  image.height = static_cast<int>(header.height);
  image.channels = header.channels;
  image.bits = header.bits;
  if (header.significant_bits <= header.bits) image.significant_bits = header.significant_bits;
  image.transfer = header.linear ? Transfer::linear : Transfer::srgb;
  if ((image.channels != 1 && image.channels != 3) || (image.bits != 8 && image.bits != 16))
    damaged("unknown kind of pixel");
  for (int i = 0; i < header.text_count; ++i)
    if (header.texts[i].text != nullptr) image.texts[header.texts[i].key] = header.texts[i].text;

  const std::size_t stride = row_bytes(image);
  std::vector<png_byte> pixels(stride * header.height);
  std::vector<png_bytep> rows(header.height);
  for (std::size_t row = 0; row < rows.size(); ++row) rows[row] = pixels.data() + row * stride;
  if (!read_rows(reader.png, reader.info, rows.data())) damaged(failure.message);
  image.samples.resize(image.sample_count());
  for (std::size_t i = 0; i < image.samples.size(); ++i)
    image.samples[i] = image.bits == 16
                           ? static_cast<std::uint16_t>(pixels[2 * i] << 8 | pixels[2 * i + 1])
                           : pixels[i];
  return image;
}

}  // namespace plenoflame
