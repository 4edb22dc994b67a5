#pragma once
#include <vector>

#include "film/lit_runs.h"
#include "plenoflame/base/execution.h"
#include "plenoflame/film/film.h"
#include "plenoflame/image/image.h"

namespace plenoflame {

/// Windows of a picture, from its top left corner. They are summed one by one, so that sums do not
/// depend on the number of threads.
using ImageParts = std::vector<PixelWindow>;

/// Parts that are all of a picture.
ImageParts whole_of(const Image& image);

/// Calls `take` with the first pixel of a run and the one after its last, for runs within the part.
/// The runs hold all pixels of the part that are not 0.
template <class Take>
void for_lit_runs(const Image& image, const PixelWindow& part, const Take& take) {
  for (int row = part.y; row < part.y + part.height; ++row) {
    const auto begin = static_cast<std::size_t>(row) * static_cast<std::size_t>(image.width) +
                       static_cast<std::size_t>(part.x);
    const std::size_t all = begin + static_cast<std::size_t>(part.width);
    for (std::size_t first = begin; first < all; first += kRun) {
      const std::size_t end = std::min(first + kRun, all);
      if (any_lit(image.pixels.data() + first, end - first)) take(first, end);
    }
  }
}

/// The largest pixel, none of which is negative; outside of the parts all are 0.
float largest_of(const Image& image, const ImageParts& parts, const Execution& execution);

/// Sum of all pixels, in double precision; outside of the parts all are 0.
double sum_of(const Image& image, const ImageParts& parts, const Execution& execution);

/// stated_error() of pictures that are 0 outside of the parts.
StatedError stated_error(const Image& flux, const Image& standard_error, int replicates,
                         const ImageParts& parts, const Execution& execution);

}  // namespace plenoflame
