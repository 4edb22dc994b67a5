#include "plenoflame/lightfield/colour.h"

#include <algorithm>
#include <cmath>

#include "plenoflame/base/error.h"
#include "plenoflame/lightfield/develop.h"

namespace plenoflame {

std::array<double, 3> linear_srgb(const std::array<double, 3>& xyz) {
  const double x = xyz[0], y = xyz[1], z = xyz[2];
  return {3.2406 * x - 1.5372 * y - 0.4986 * z, -0.9689 * x + 1.8758 * y + 0.0415 * z,
          0.0557 * x - 0.2040 * y + 1.0570 * z};
}

PngImage colour_picture(const std::array<const Image*, 3>& images, const ColourSettings& settings) {
  const Image& first = *images[0];
  for (const Image* image : images) {
    if (image->width != first.width || image->height != first.height || image->empty())
      throw InputError("a colour picture needs three channels of the same size");
    for (const float value : image->pixels)
      if (!std::isfinite(value))
        throw InputError("the light field holds a value that is not finite");
  }
  double white = settings.saturation;
  if (!(white > 0)) {
    if (settings.is_xyz) white = automatic_saturation(*images[1]);
    for (std::size_t c = 0; c < 3 && !settings.is_xyz; ++c)
      white = std::max(white, automatic_saturation(*images[c]));
  }
  const double scale = white > 0 ? 1 / white : 0;
  PngImage picture;
  picture.width = first.width;
  picture.height = first.height;
  picture.channels = 3;
  picture.bits = 8;
  picture.transfer = Transfer::srgb;
  picture.samples.reserve(3 * first.pixels.size());
  for (std::size_t i = 0; i < first.pixels.size(); ++i) {
    std::array<double, 3> values{};
    for (std::size_t c = 0; c < 3; ++c)
      values[c] = scale * static_cast<double>(images[c]->pixels[i]);
    if (settings.is_xyz) values = linear_srgb(values);
    for (const double value : values)
      picture.samples.push_back(
          static_cast<std::uint16_t>(std::lround(255 * encode_srgb(std::clamp(value, 0.0, 1.0)))));
  }
  return picture;
}

}  // namespace plenoflame
