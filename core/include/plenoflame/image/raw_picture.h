#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace plenoflame {

/// State of a pixel of an imported picture (layer "sensor.state").
enum class PixelState : std::uint8_t { good = 0, defective = 1, saturated = 2 };

/// Contents of a camera's file: whole numbers, row by row from the top left, channels interleaved.
struct RawPicture {
  int width = 0;
  int height = 0;
  int channels = 1;            ///< 1: grey or a mosaic, 3: RGB
  int bits = 16;               ///< that a number may have, 1 to 16
  std::string kind;            ///< "TIFF", "PNG", "headerless" and others, for messages
  bool display_curve = false;  ///< the file says that its numbers follow a display's curve
  bool lossy = false;          ///< it was packed with losses (JPEG, also within TIFF)
  std::vector<std::uint16_t> samples;

  std::size_t pixel_count() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
};

/// The layout of a file that does not say what it holds.
struct RawLayout {
  int width = 0, height = 0;  ///< 0: such files are refused
  int bits = 16;              ///< up to 8: one byte for a number, above: two
  bool big_endian = false;
  std::uint64_t skip = 0;  ///< bytes in front of the first picture
};

/// Reads all pictures of a file in turn; only one picture is held at a time. Formats: the pages of
/// a TIFF (strips or tiles, 1 to 16 bits), a PNG, a PGM (P5). A JPEG of 8 bits is marked as lossy.
/// A PNG has 8 or 16 bits, or the significant bits that it declares. Numbers without header are
/// read as `layout` says. Frames of an array in HDF5 or MAT 5 are pictures, too; FILE:ARRAY names
/// the array where there are several, or a picture of a Lytro camera's data base. A Lytro camera's
/// file holds packed numbers of 10 or 12 bits.
/// @throws FileError: cannot be read, no picture, cut off, damaged, unsupported kind (floating
///         point, palettes, arrays of other numbers than counts). Sizes in the header are checked
///         before memory is allocated
void read_raw_pictures(const std::string& name, const RawLayout& layout,
                       const std::function<void(RawPicture&&)>& take);

/// The picture mirrored left to right if `mirror`, then turned clockwise by quarter turns.
RawPicture turned(RawPicture picture, int quarter_turns, bool mirror);

}  // namespace plenoflame
