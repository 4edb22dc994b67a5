#pragma once
#include <cstddef>
#include <vector>

#include "lightfield/micro_image_kernel.h"

namespace plenoflame {

/// Light and white light, in pixels of a refocused picture.
struct RefocusSums {
  int width = 0, height = 0;
  std::vector<double> light, white, square;  ///< square: of the radiance; empty: not requested
  RefocusSums(int w, int h, bool with_square = false)
      : width(w),
        height(h),
        light(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)),
        white(light),
        square(with_square ? light.size() : 0) {}
  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(column);
  }
};

/// Contribution of a part of the micro-images. It holds the rows of the picture that this part
/// meets, with a margin of one pixel, so that a sample needs one address only.
class RefocusBand {
 public:
  RefocusBand(int width, int height, bool with_square)
      : width_(width),
        height_(height),
        with_square_(with_square),
        rows_(static_cast<std::size_t>(height) + 2) {}

  /// Spreads samples over the four pixels around each, bilinearly. Places count from the middle of
  /// pixel (column, row); samples without white light do not count.
  void add(int column, int row, std::size_t count, const KernelSamples& samples);
  void add_to(RefocusSums& sums) const;

 private:
  struct Cell {
    double light = 0, white = 0;
  };
  struct Row {
    std::vector<Cell> cells;
    std::vector<double> square;
  };
  Row& row_at(int row);

  int width_, height_;
  bool with_square_;
  std::vector<Row> rows_;  ///< empty: not met; the first is that above the picture
};

/// Fills pixels without samples from their surroundings. A level of half the size, filled in the
/// same way, counts with a weight too small to show where there are samples.
void fill_gaps(RefocusSums& sums);

}  // namespace plenoflame
