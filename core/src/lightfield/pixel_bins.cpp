#include "plenoflame/lightfield/pixel_bins.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "plenoflame/base/error.h"

namespace plenoflame {

PixelBins block_bins(const PixelWindow& window, int side) {
  if (side < 1) throw InputError("a block has a side of at least 1 pixel");
  const int across = (window.width + side - 1) / side, down = (window.height + side - 1) / side;
  PixelBins bins;
  bins.count = static_cast<std::size_t>(across) * static_cast<std::size_t>(down);
  for (int row = 0; row < window.height; ++row)
    for (int column = 0; column < window.width; ++column)
      bins.of_pixel.push_back(row / side * across + column / side);
  return bins;
}

PixelBins micro_image_bins(const MicroImages& images, const PixelWindow& window, int cells) {
  if (cells < 1) throw InputError("a micro-image is parted into at least 1 cell");
  const Camera& camera = images.camera();
  // From a sensor point to the microlens in front of it, as the light of the exit pupil's middle
  // goes.
  const double exit = camera.exit_pupil();
  const double scale =
      std::isfinite(exit) ? (exit - camera.array_back()) / (exit - camera.sensor()) : 1;
  PixelBins bins;
  std::map<std::array<int, 4>, std::int32_t> numbers;
  for (int row = 0; row < window.height; ++row)
    for (int column = 0; column < window.width; ++column) {
      const Vec2 s = camera.sensor_point(window.x + column + 0.5, window.y + row + 0.5);
      const MicroImages::Place place =
          images.place(camera.lattice().nearest(camera.foot() + scale * (s - camera.foot())));
      const Vec2 away = s - place.centre;
      if (place.dark || !(length(away) <= place.radius)) {
        bins.of_pixel.push_back(-1);
        continue;
      }
      const auto cell = [&](double offset) {
        const double share = 0.5 * (offset / place.radius + 1);
        return std::clamp(static_cast<int>(std::floor(cells * share)), 0, cells - 1);
      };
      const std::array<int, 4> key{place.lens.q, place.lens.r, cell(away.x), cell(away.y)};
      const auto [found, added] =
          numbers.try_emplace(key, static_cast<std::int32_t>(numbers.size()));
      bins.of_pixel.push_back(found->second);
    }
  bins.count = numbers.size();
  return bins;
}

}  // namespace plenoflame
