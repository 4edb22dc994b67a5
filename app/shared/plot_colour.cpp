#include "plot.h"

// Apart from the drawing, for those who build plots without Cairo.
namespace plenoflame {

std::array<double, 3> plot_colour(std::size_t k) {
  constexpr std::array<double, 3> colours[] = {{0.75, 0.1, 0.1}, {0.1, 0.35, 0.75},
                                               {0.1, 0.55, 0.2}, {0.55, 0.25, 0.6},
                                               {0.8, 0.5, 0.05}, {0.1, 0.1, 0.1}};
  return colours[k % std::size(colours)];
}

}  // namespace plenoflame
