#include "plenoflame/image/raw_picture.h"

#include <algorithm>
#include <array>
#include <bit>
#include <filesystem>
#include <fstream>
#include <string_view>

#include "image/jpeg_picture.h"
#include "image/picture_arrays.h"
#include "image/tiff_pages.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/mended_by.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/image/png_file.h"

namespace plenoflame {
namespace {

RawPicture picture_of_png(const std::string& path) {
  PngImage png = read_png(path);
  RawPicture picture;
  picture.kind = "PNG";
  picture.width = png.width;
  picture.height = png.height;
  picture.channels = png.channels;
  picture.bits = png.bits;
  // 8 bits with the mark sRGB are a picture for display; 16 bits without a mark are a camera's.
  picture.display_curve = png.transfer == Transfer::srgb && png.bits == 8;
  picture.samples = std::move(png.samples);
  if (png.significant_bits > 0 && png.significant_bits < png.bits) {
    picture.bits = png.significant_bits;
    for (std::uint16_t& sample : picture.samples)
      sample = static_cast<std::uint16_t>(sample >> (png.bits - png.significant_bits));
  }
  return picture;
}

/// A whole number of a PGM's header, after blanks and comments.
std::uint32_t header_number(const std::string& path, const std::string& bytes, std::size_t& at) {
  while (at < bytes.size()) {
    if (bytes[at] == '#')
      while (at < bytes.size() && bytes[at] != '\n') ++at;
    else if (std::string_view(" \t\r\n").find(bytes[at]) == std::string_view::npos)
      break;
    else
      ++at;
  }
  std::uint32_t number = 0;
  const std::size_t begin = at;
  for (; at < bytes.size() && bytes[at] >= '0' && bytes[at] <= '9'; ++at) {
    number = 10 * number + static_cast<std::uint32_t>(bytes[at] - '0');
    if (number > 1000000) refuse_picture(path, "damaged PGM (a number of its header)");
  }
  if (at == begin) refuse_picture(path, "damaged PGM (its header lacks a number)");
  return number;
}

/// Numbers of one or two bytes. @param at where they begin
void take_numbers(const std::string& bytes, std::size_t at, bool two_bytes, bool big_endian,
                  std::vector<std::uint16_t>& out) {
  const auto* from = reinterpret_cast<const unsigned char*>(bytes.data()) + at;
  for (std::size_t i = 0; i < out.size(); ++i)
    if (!two_bytes)
      out[i] = from[i];
    else if (big_endian)
      out[i] = static_cast<std::uint16_t>(from[2 * i] << 8 | from[2 * i + 1]);
    else
      out[i] = static_cast<std::uint16_t>(from[2 * i + 1] << 8 | from[2 * i]);
}

RawPicture picture_of_pgm(const std::string& path, const std::string& bytes) {
  std::size_t at = 2;
  const std::uint32_t width = header_number(path, bytes, at);
  const std::uint32_t height = header_number(path, bytes, at);
  const std::uint32_t largest = header_number(path, bytes, at);
  ++at;  // one blank before the pixels
  if (width == 0 || height == 0 || largest == 0 || largest > 65535)
    refuse_picture(path, "damaged PGM (its size, or its largest value)");
  const std::uint64_t numbers = std::uint64_t{width} * height;
  const bool two = largest > 255;
  if (at > bytes.size() || (bytes.size() - at) / (two ? 2 : 1) < numbers)
    refuse_picture(path, "the PGM is too short for its size: cut off");
  RawPicture picture;
  picture.kind = "PGM";
  picture.width = static_cast<int>(width);
  picture.height = static_cast<int>(height);
  picture.bits = static_cast<int>(std::bit_width(largest));
  picture.samples.resize(numbers);
  take_numbers(bytes, at, two, true, picture.samples);
  return picture;
}

void read_headerless(const std::string& path, const std::string& bytes, const RawLayout& layout,
                     const std::function<void(RawPicture&&)>& take) {
  const std::uint64_t numbers =
      static_cast<std::uint64_t>(layout.width) * static_cast<std::uint64_t>(layout.height);
  const std::uint64_t size = numbers * (layout.bits > 8 ? 2 : 1);
  const std::uint64_t there = bytes.size() - std::min<std::uint64_t>(layout.skip, bytes.size());
  if (size == 0 || there < size || there % size != 0)
    refuse_picture(path, "it has " + std::to_string(there) + " bytes" +
                             (layout.skip > 0 ? " behind those that are skipped" : "") + ", and " +
                             std::to_string(layout.width) + " x " + std::to_string(layout.height) +
                             " numbers of " + std::to_string(layout.bits) + " bits take " +
                             std::to_string(size) +
                             ": no whole number of pictures; check size, bits and what is skipped");
  for (std::uint64_t at = layout.skip; at + size <= bytes.size(); at += size) {
    RawPicture picture;
    picture.kind = "headerless";
    picture.width = layout.width;
    picture.height = layout.height;
    picture.bits = layout.bits;
    picture.samples.resize(numbers);
    take_numbers(bytes, at, layout.bits > 8, layout.big_endian, picture.samples);
    const std::uint32_t largest = (1U << layout.bits) - 1;
    if (std::any_of(picture.samples.begin(), picture.samples.end(),
                    [&](std::uint16_t sample) { return sample > largest; }))
      refuse_picture(path, "it holds numbers above " + std::to_string(largest) +
                               ", the largest of " + std::to_string(layout.bits) +
                               " bits: check the bits and the order of bytes");
    take(std::move(picture));
  }
}

/// The end of the file's name in FILE:ARRAY; npos where the whole is a file's name.
std::size_t end_of_file_name(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored)) return std::string::npos;
  for (std::size_t at = path.find(':'); at != std::string::npos; at = path.find(':', at + 1))
    if (std::filesystem::is_regular_file(path.substr(0, at), ignored)) return at;
  return std::string::npos;
}

/// True if an HDF5 file begins at 0, or behind the block of MATLAB 7.3. Pipes are not read.
bool is_hdf5(const std::string& path) {
  constexpr std::string_view kSignature("\x89HDF\r\n\x1a\n", 8);
  constexpr std::size_t kMatlabBlock = 512;  // bytes
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return false;
  std::array<char, kMatlabBlock + kSignature.size()> bytes{};
  std::ifstream(path, std::ios::binary).read(bytes.data(), std::streamsize{bytes.size()});
  const std::string_view head(bytes.data(), bytes.size());
  return head.starts_with(kSignature) || head.ends_with(kSignature);
}

}  // namespace

void read_raw_pictures(const std::string& name, const RawLayout& layout,
                       const std::function<void(RawPicture&&)>& take) {
  const std::size_t end = end_of_file_name(name);
  const std::string path = name.substr(0, end),
                    array = end == std::string::npos ? "" : name.substr(end + 1);
  if (is_hdf5(path)) {
    read_hdf5_pictures(path, array, take);
    return;
  }
  const std::string bytes = read_file(path);
  const auto begins = [&](std::string_view with) { return bytes.starts_with(with); };
  constexpr std::string_view kTiff[] = {{"II*\0", 4}, {"MM\0*", 4}, {"II+\0", 4}, {"MM\0+", 4}};
  if (begins("MATLAB 5.0 MAT-file")) {
    read_mat_pictures(path, bytes, array, take);
  } else if (begins("\x89LFP")) {
    read_lytro_pictures(path, bytes, array, take);
  } else if (!array.empty()) {
    refuse_picture(name, "arrays have names in HDF5, .mat and Lytro files alone");
  } else if (layout.width == 0 && is_lytro_raw(bytes.size())) {
    take(lytro_raw_picture(path, bytes));
  } else if (std::any_of(std::begin(kTiff), std::end(kTiff), begins)) {
    read_tiff_pages(path, bytes, take);
  } else if (begins("\x89PNG")) {
    take(picture_of_png(path));
  } else if (begins("P5")) {
    take(picture_of_pgm(path, bytes));
  } else if (begins("\xff\xd8\xff")) {
    take(read_jpeg_picture(path, bytes));
  } else if (begins("\x76\x2f\x31\x01")) {
    refuse_picture(path,
                   "an OpenEXR file is no camera's picture; a light field (.exr) is there "
                   "already and needs no import");
  } else if (layout.width > 0) {
    read_headerless(path, bytes, layout, take);
  } else if (bytes.empty()) {
    refuse_picture(path, "it is empty");
  } else if (path.ends_with(".mat")) {
    refuse_picture(path, "it is no .mat file of MATLAB 5 or later; save it there with '-v7'");
  } else if (path.ends_with(".h5")) {
    refuse_picture(path, "it is no HDF5 file");
  } else {
    throw mended_by(FileError("cannot read '" + path +
                              "': neither TIFF, PNG, PGM, JPEG, HDF5, .mat nor Lytro; numbers "
                              "without header need their layout"),
                    {"size", "bits", "endian"});
  }
}

RawPicture turned(RawPicture picture, int quarter_turns, bool mirror) {
  const int turns = (quarter_turns % 4 + 4) % 4;
  if (turns == 0 && !mirror) return picture;
  const int width = picture.width, height = picture.height, channels = picture.channels;
  const bool lies = turns % 2 != 0;
  RawPicture out = picture;
  out.width = lies ? height : width;
  out.height = lies ? width : height;
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      // The pixel's origin: a clockwise quarter turn brings the left column to the top.
      int column = turns == 1 ? y : turns == 2 ? width - 1 - x : turns == 3 ? width - 1 - y : x;
      const int row = turns == 1   ? height - 1 - x
                      : turns == 2 ? height - 1 - y
                      : turns == 3 ? x
                                   : y;
      if (mirror) column = width - 1 - column;
      const auto from = (static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                         static_cast<std::size_t>(column)) *
                        static_cast<std::size_t>(channels);
      const auto to = (static_cast<std::size_t>(y) * static_cast<std::size_t>(out.width) +
                       static_cast<std::size_t>(x)) *
                      static_cast<std::size_t>(channels);
      std::copy_n(picture.samples.begin() + static_cast<std::ptrdiff_t>(from), channels,
                  out.samples.begin() + static_cast<std::ptrdiff_t>(to));
    }
  return out;
}

}  // namespace plenoflame
