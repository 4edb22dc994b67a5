#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "plenoflame/image/pixel_values.h"

namespace plenoflame {

/// Part of a sensor: columns [x, x + width), rows [y, y + height) of the upright image.
struct PixelWindow {
  int x = 0, y = 0, width = 0, height = 0;
  friend bool operator==(const PixelWindow&, const PixelWindow&) = default;
};

/// One channel of pixels, row by row from the top left, in single precision.
struct Image {
  int width = 0;
  int height = 0;
  PixelValues pixels;

  Image() = default;
  /// All 0.
  Image(int w, int h)
      : width(w), height(h), pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
  Image(int w, int h, float value)
      : width(w),
        height(h),
        pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), value) {}
  bool empty() const { return pixels.empty(); }
  float& at(int column, int row) {
    return pixels[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(column)];
  }
  float at(int column, int row) const {
    return pixels[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(column)];
  }

  friend bool operator==(const Image&, const Image&) = default;
};

}  // namespace plenoflame
