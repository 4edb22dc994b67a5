#include "image/jpeg_picture.h"

#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstdio>

// libjpeg's header wants size_t and FILE to be there.
#include <jpeglib.h>

#include "plenoflame/base/error.h"
#include "plenoflame/base/printable.h"

namespace plenoflame {
namespace {

// libjpeg reports errors by a function that must not return; a longjmp must not pass objects with
// destructors. The functions between setjmp and libjpeg therefore hold plain values only.

struct Decoder {
  jpeg_decompress_struct jpeg{};
  jpeg_error_mgr errors{};
  std::jmp_buf back{};
  std::array<char, JMSG_LENGTH_MAX> message{};
};

[[noreturn]] void on_jpeg_error(j_common_ptr jpeg) {
  auto* decoder = static_cast<Decoder*>(jpeg->client_data);
  jpeg->err->format_message(jpeg, decoder->message.data());
  std::longjmp(decoder->back, 1);
}

/// A warning of libjpeg means damage: it would fill missing parts with grey.
void on_jpeg_message(j_common_ptr jpeg, int level) {
  if (level < 0) on_jpeg_error(jpeg);
}

bool read_jpeg_header(Decoder& decoder, const std::string& bytes) {
  jpeg_decompress_struct& jpeg = decoder.jpeg;
  jpeg.err = jpeg_std_error(&decoder.errors);
  decoder.errors.error_exit = on_jpeg_error;
  decoder.errors.emit_message = on_jpeg_message;
  jpeg.client_data = &decoder;
  if (setjmp(decoder.back) != 0) return false;
  jpeg_create_decompress(&jpeg);
  jpeg_mem_src(&jpeg, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  jpeg_read_header(&jpeg, TRUE);
  return true;
}

void take_row(const unsigned char* row, std::size_t numbers, std::size_t number,
              std::uint16_t* samples) {
  std::copy_n(row, numbers, samples + number * numbers);
}

/// @param row holds one row @param samples the whole picture
bool read_jpeg_rows(Decoder& decoder, unsigned char* row, std::uint16_t* samples) {
  jpeg_decompress_struct& jpeg = decoder.jpeg;
  if (setjmp(decoder.back) != 0) return false;
  jpeg.out_color_space = jpeg.num_components == 1 ? JCS_GRAYSCALE : JCS_RGB;
  jpeg_start_decompress(&jpeg);
  while (jpeg.output_scanline < jpeg.output_height) {
    jpeg_read_scanlines(&jpeg, &row, 1);
    take_row(row, std::size_t{jpeg.output_width} * static_cast<std::size_t>(jpeg.num_components),
             jpeg.output_scanline - 1, samples);
  }
  jpeg_finish_decompress(&jpeg);
  return true;
}

/// Gives back what libjpeg has taken.
class DecoderGuard {
 public:
  explicit DecoderGuard(Decoder& decoder) : decoder_(decoder) {}
  ~DecoderGuard() { jpeg_destroy_decompress(&decoder_.jpeg); }
  DecoderGuard(const DecoderGuard&) = delete;
  DecoderGuard& operator=(const DecoderGuard&) = delete;

 private:
  Decoder& decoder_;
};

}  // namespace

RawPicture read_jpeg_picture(const std::string& path, const std::string& bytes) {
  Decoder decoder;
  const DecoderGuard guard(decoder);
  const auto fail = [&](const std::string& why) -> void {
    throw FileError("cannot read '" + path + "': " + why);
  };
  const auto damaged = [&] {
    fail("damaged JPEG, or cut off (" + printable(decoder.message.data()) + ")");
  };
  if (!read_jpeg_header(decoder, bytes)) damaged();
  const jpeg_decompress_struct& jpeg = decoder.jpeg;
  if (jpeg.num_components != 1 && jpeg.num_components != 3)
    fail("a JPEG of printing colours is no raw picture; save it grey or RGB");
  const std::uint64_t pixels = std::uint64_t{jpeg.image_width} * jpeg.image_height;
  constexpr std::uint64_t kMostPixels = 1000000000;
  // A block of 64 pixels takes one bit at least.
  constexpr std::uint64_t kMostPixelsPerByte = 512;
  if (pixels > kMostPixels || pixels / kMostPixelsPerByte > bytes.size())
    fail("the JPEG is too short for its size: cut off");
  RawPicture picture;
  picture.kind = "JPEG";
  picture.width = static_cast<int>(jpeg.image_width);
  picture.height = static_cast<int>(jpeg.image_height);
  picture.channels = jpeg.num_components;
  picture.bits = 8;
  picture.lossy = true;
  const auto row = static_cast<std::size_t>(picture.width * picture.channels);
  std::vector<unsigned char> line(row);
  picture.samples.resize(row * static_cast<std::size_t>(picture.height));
  if (!read_jpeg_rows(decoder, line.data(), picture.samples.data())) damaged();
  return picture;
}

}  // namespace plenoflame
