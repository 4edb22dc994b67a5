/// The pixels of a micro-image and their white light, with vector code.
#include "lightfield/micro_image_pixels.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/isa_dispatch.h"
#include "plenoflame/lightfield/micro_images.h"

namespace plenoflame {

MicroImageKernels micro_image_kernels(Isa isa) {
  PLENOFLAME_DISPATCH(isa, return {kernels::white_light, kernels::project};)
}

void MicroImages::Pixels::set(const SensorSpec& sensor, const PixelWindow& window, Vec2 middle,
                              double radius) {
  pitch = sensor.pixel();
  centre = middle;
  rows.clear();
  x.clear();
  y.clear();
  const double centre_x = 0.5 * sensor.columns - middle.x / pitch.x,
               centre_y = 0.5 * sensor.rows - middle.y / pitch.y;
  const double reach = radius / pitch.x, reach_y = radius / pitch.y, stretch = pitch.y / pitch.x;
  const auto bound = [](double value, int low, int high) {
    return static_cast<int>(std::clamp(value, static_cast<double>(low), static_cast<double>(high)));
  };
  const int last_row =
      bound(std::floor(centre_y + reach_y - 0.5) + 1, window.y, window.y + window.height);
  for (int row = bound(std::ceil(centre_y - reach_y - 0.5), window.y, window.y + window.height);
       row < last_row; ++row) {
    const double above = row + 0.5 - centre_y, in_widths = above * stretch;
    const double half = std::sqrt(std::max(0.0, reach * reach - in_widths * in_widths));
    const int first = bound(std::ceil(centre_x - half - 0.5), window.x, window.x + window.width);
    const int last =
        bound(std::floor(centre_x + half - 0.5) + 1, window.x, window.x + window.width);
    if (first >= last) continue;
    rows.push_back({row, first, x.size(), static_cast<std::size_t>(last - first)});
    for (int column = first; column < last; ++column) {
      x.push_back(static_cast<float>(column + 0.5 - centre_x));
      y.push_back(static_cast<float>(above));
    }
  }
}

void MicroImages::WhiteTable::values(Vec2 origin, Vec2 pitch, const std::vector<float>& x,
                                     const std::vector<float>& y, Isa isa,
                                     std::vector<float>& out) const {
  // In the table's axes; a step to the right of the upright picture is one to -x of the camera.
  const Vec2 from = origin - centre_;
  const Vec2 v{from.x * outwards_.x + from.y * outwards_.y,
               from.y * outwards_.x - from.x * outwards_.y};
  std::array<KernelWhitePart, kMostParts> parts{};
  for (std::size_t n = 0; n < count_; ++n) {
    const Part& part = parts_[n];
    const double step_x = -pitch.x * part.scale, step_y = -pitch.y * part.scale;
    parts[n] = {part.table,
                static_cast<float>(part.weight),
                static_cast<float>((v.x + part.half) * part.scale),
                static_cast<float>(step_x * outwards_.x),
                static_cast<float>(step_y * outwards_.y),
                static_cast<float>((v.y + part.half) * part.scale),
                static_cast<float>(-step_x * outwards_.y),
                static_cast<float>(step_y * outwards_.x)};
  }
  out.resize(x.size());
  micro_image_kernels(isa).white_light(parts.data(), static_cast<int>(count_), kWhiteSide,
                                       static_cast<int>(x.size()), x.data(), y.data(), out.data());
}

void MicroImages::LocalWhite::fill(Pixels& pixels, Isa isa) const {
  const Vec2 p = pixels.pitch;
  const double stretch = p.y / p.x;
  own_.values(pixels.centre, p, pixels.x, pixels.y, isa, pixels.own);
  pixels.total = pixels.own;
  for (const WhiteTable& other : others_) {
    // The pixels within its reach, which are few: gathered first.
    Pixels::Some& some = pixels.some;
    some.at.clear();
    some.x.clear();
    some.y.clear();
    const Vec2 between = other.centre() - pixels.centre;
    const Vec2 apart{(-1 / p.x) * between.x, (-1 / p.y) * between.y};
    const double reach = other.reach() / p.x;
    for (const Pixels::Row& row : pixels.rows) {
      const double left = static_cast<double>(pixels.x[row.begin]),
                   above = static_cast<double>(pixels.y[row.begin]);
      const double in_widths = (above - apart.y) * stretch;
      const double square = reach * reach - in_widths * in_widths;
      if (!(square > 0)) continue;
      const double half = std::sqrt(square), last = static_cast<double>(row.count);
      const auto begin = static_cast<std::size_t>(
                     std::clamp(std::ceil(apart.x - half - left), 0.0, last)),
                 end = static_cast<std::size_t>(
                     std::clamp(std::floor(apart.x + half - left) + 1, 0.0, last));
      for (std::size_t k = row.begin + begin; k < row.begin + end; ++k) {
        some.at.push_back(static_cast<int>(k));
        some.x.push_back(pixels.x[k]);
        some.y.push_back(pixels.y[k]);
      }
    }
    if (some.at.empty()) continue;
    other.values(pixels.centre, p, some.x, some.y, isa, some.value);
    for (std::size_t k = 0; k < some.at.size(); ++k)
      pixels.total[static_cast<std::size_t>(some.at[k])] += some.value[k];
  }
}

}  // namespace plenoflame
