#include "solids/texture.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "plenoflame/base/constants.h"
#include "plenoflame/image/png_file.h"

namespace plenoflame {
namespace {

/// IEC 61966-2-1.
double from_srgb(double value) {
  return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

std::string in_folder(const std::string& file, const std::string& folder) {
  return folder.empty() || file.starts_with('/') ? file : folder + "/" + file;
}

}  // namespace

Texture::Texture(const TextureSpec& spec, double light, const std::string& folder)
    : spec_(spec), light_(light) {
  if (spec.kind != TextureKind::image) return;
  const PngImage image = read_png(in_folder(spec.file, folder));
  width_ = image.width;
  height_ = image.height;
  const double top = static_cast<double>((1u << image.bits) - 1);
  const auto light_of = [&](std::size_t sample) {
    const double value = image.samples[sample] / top;
    return image.transfer == Transfer::srgb ? from_srgb(value) : value;
  };
  const auto channels = static_cast<std::size_t>(image.channels);
  pixels_.resize(image.sample_count() / channels);
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    // Luminance of linear RGB: ITU-R BT.709.
    const double value = channels < 3 ? light_of(i * channels)
                                      : 0.2126 * light_of(i * channels) +
                                            0.7152 * light_of(i * channels + 1) +
                                            0.0722 * light_of(i * channels + 2);
    pixels_[i] = static_cast<float>(value);
  }
}

double Texture::reflectivity(Vec2 at) const {
  if (spec_.kind == TextureKind::none) return light_;
  if (spec_.kind == TextureKind::image) return spec_.dark + (light_ - spec_.dark) * image_value(at);
  return dark(at) ? spec_.dark : light_;
}

bool Texture::dark(Vec2 at) const {
  const double columns = spec_.columns, rows = spec_.rows;
  switch (spec_.kind) {
    case TextureKind::checkerboard: {
      const double x = at.x / spec_.cell + 0.5 * columns, y = 0.5 * rows - at.y / spec_.cell;
      if (!(x >= 0 && x < columns && y >= 0 && y < rows)) return false;
      return (static_cast<int>(x) + static_cast<int>(y)) % 2 == 0;
    }
    case TextureKind::dots: {
      const double x = at.x / spec_.cell + 0.5 * (columns - 1);
      const double y = 0.5 * (rows - 1) - at.y / spec_.cell;
      const double i = std::round(x), j = std::round(y);
      if (!(i >= 0 && i < columns && j >= 0 && j < rows)) return false;
      return std::hypot(x - i, y - j) < 0.5 * spec_.fill;
    }
    case TextureKind::siemens_star: {
      if (!(2 * length(at) < std::min(spec_.size.x, spec_.size.y))) return false;
      const double turn = std::atan2(at.y, at.x) / (2 * constants::pi) + 1;
      return static_cast<int>(2 * columns * turn) % 2 == 0;
    }
    case TextureKind::bars:
      return dark_bar(at);
    default:
      return false;
  }
}

/// Groups of three upright bars above three level ones, bars and gaps half a period wide and two
/// and a half long (as in MIL-STD-150A). Each group's period is that of the one before over the
/// square root of 2. Groups follow one another to the right, a period apart, the whole centred.
bool Texture::dark_bar(Vec2 at) const {
  double total = 0, period = spec_.cell;
  for (int group = 0; group < spec_.columns; ++group, period *= std::sqrt(0.5))
    total += 3.5 * period;
  double left = -0.5 * total;
  period = spec_.cell;
  for (int group = 0; group < spec_.columns; ++group, period *= std::sqrt(0.5)) {
    const double x = at.x - left, side = 2.5 * period;
    left += 3.5 * period;
    if (x < 0 || x >= side) continue;
    // Upright bars from y = period / 2 up, level ones from -period / 2 down.
    const double y = std::fabs(at.y) - 0.5 * period;
    if (y < 0 || y >= side) return false;
    return static_cast<int>((at.y > 0 ? x : y) / (0.5 * period)) % 2 == 0;
  }
  return false;
}

double Texture::image_value(Vec2 at) const {
  // Bilinear between the centres of pixels; beyond the edge the image is white.
  const double x = (at.x / spec_.size.x + 0.5) * width_, y = (0.5 - at.y / spec_.size.y) * height_;
  if (!(x >= 0 && x <= width_ && y >= 0 && y <= height_)) return 1;
  const auto pixel = [&](int column, int row) {
    column = std::clamp(column, 0, width_ - 1);
    row = std::clamp(row, 0, height_ - 1);
    return static_cast<double>(
        pixels_[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
                static_cast<std::size_t>(column)]);
  };
  const int i = static_cast<int>(std::floor(x - 0.5)), j = static_cast<int>(std::floor(y - 0.5));
  const double u = x - 0.5 - i, v = y - 0.5 - j;
  return (1 - v) * ((1 - u) * pixel(i, j) + u * pixel(i + 1, j)) +
         v * ((1 - u) * pixel(i, j + 1) + u * pixel(i + 1, j + 1));
}

std::vector<Texture::Mark> Texture::marks() const {
  std::vector<Mark> marks;
  const bool board = spec_.kind == TextureKind::checkerboard;
  if (!board && spec_.kind != TextureKind::dots) return marks;
  const int columns = spec_.columns - (board ? 1 : 0), rows = spec_.rows - (board ? 1 : 0);
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      marks.push_back(
          {column,
           row,
           {(column - 0.5 * (columns - 1)) * spec_.cell, (0.5 * (rows - 1) - row) * spec_.cell}});
  return marks;
}

double Texture::feature_size() const {
  switch (spec_.kind) {
    case TextureKind::checkerboard:
      return spec_.cell;
    case TextureKind::dots:
      return spec_.fill * spec_.cell;
    case TextureKind::bars:
      return 0.5 * spec_.cell * std::pow(0.5, 0.5 * (spec_.columns - 1));
    case TextureKind::siemens_star:
      // Sectors are resolved down to a tenth of the radius.
      return 0.1 * constants::pi * std::min(spec_.size.x, spec_.size.y) / (2.0 * spec_.columns);
    case TextureKind::image:
      return std::min(spec_.size.x / width_, spec_.size.y / height_);
    case TextureKind::none:
      break;
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace plenoflame
