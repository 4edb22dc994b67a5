#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <stop_token>
#include <string>
#include <vector>

namespace plenoflame {

/// The relation of sample values to light.
enum class Transfer {
  srgb,    ///< IEC 61966-2-1: for display (chunk sRGB)
  linear,  ///< proportional to light (chunk gAMA = 1)
};

/// A grey or RGB picture of whole numbers, row by row from the top left, channels interleaved.
struct PngImage {
  int width = 0;
  int height = 0;
  int channels = 1;  ///< 1: grey, 3: RGB
  int bits = 8;      ///< per sample: 8 or 16
  /// Number of the bits that carry information (chunk sBIT); 0: all. The value itself is
  /// sample >> (bits - significant_bits); the lower bits repeat the upper ones.
  int significant_bits = 0;
  Transfer transfer = Transfer::srgb;
  std::vector<std::uint16_t> samples;
  std::map<std::string, std::string> texts;  ///< keyword (1 to 79 characters) and text

  std::size_t sample_count() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
           static_cast<std::size_t>(channels);
  }
};

/// Writes a PNG under a temporary name that is renamed at the end.
/// @throws FileError (cannot be written)
/// @throws InputError (sizes that do not fit together, a sample that exceeds the bits)
/// @throws Cancelled (a stop was requested: no file is left)
void write_png(const std::string& path, const PngImage& image, const std::stop_token& stop = {});

/// Reads any PNG as grey or RGB. Palettes are resolved, transparency is dropped, and fewer than 8
/// bits become 8. @throws FileError (cannot be read, not a PNG, damaged)
PngImage read_png(const std::string& path);

}  // namespace plenoflame
