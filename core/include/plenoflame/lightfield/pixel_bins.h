#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "plenoflame/image/image.h"
#include "plenoflame/lightfield/micro_images.h"

namespace plenoflame {

/// The pixels of a window that are taken together.
struct PixelBins {
  std::size_t count = 0;
  std::vector<std::int32_t> of_pixel;  ///< row by row: number of its bin, from 0; -1: in none
};

/// Blocks of side x side pixels, from the window's upper left corner. Blocks at the other edges are
/// smaller. @throws InputError for a side below 1
PixelBins block_bins(const PixelWindow& window, int side);

/// The pixels of each micro-image: those whose centres lie in the image of the stop. They are
/// divided into the cells of a grid of `cells` x `cells` over the square around it. A cell gathers
/// light of one part of the main lens' pupil through one microlens. One cell gathers all light of
/// the microlens; of several, each is a pixel of a view.
/// @throws InputError for cells below 1
PixelBins micro_image_bins(const MicroImages& images, const PixelWindow& window, int cells);

}  // namespace plenoflame
