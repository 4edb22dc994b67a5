#include "model/image_display.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <mutex>

#include "plenoflame/base/error.h"

namespace plenoflame::desktop {
namespace {

constexpr std::uint32_t kOpaque = 0xff000000U;
constexpr std::uint32_t kSaturated = 0xffff2a6dU;  ///< in none of the maps
constexpr int kLeastSide = 64;                     ///< of the last level of a pyramid

/// Transfer curve of sRGB (IEC 61966-2-1).
double srgb(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

std::shared_ptr<const Image> halved(const Image& in, const Execution& execution) {
  auto out = std::make_shared<Image>((in.width + 1) / 2, (in.height + 1) / 2);
  const bool done =
      parallel_for(execution, static_cast<std::size_t>(out->height), [&](std::size_t index, int) {
        const int row = static_cast<int>(index);
        const int y0 = 2 * row, y1 = std::min(y0 + 1, in.height - 1);
        for (int column = 0; column < out->width; ++column) {
          const int x0 = 2 * column, x1 = std::min(x0 + 1, in.width - 1);
          out->at(column, row) =
              0.25F * (in.at(x0, y0) + in.at(x1, y0) + in.at(x0, y1) + in.at(x1, y1));
        }
      });
  if (!done) throw Cancelled();
  return out;
}

}  // namespace

double tone(const ToneSettings& settings, double value) {
  if (std::isnan(value)) return 0;
  const double share = value / settings.white;
  if (settings.is_signed) return std::clamp(0.5 + 0.5 * share, 0.0, 1.0);
  switch (settings.scale) {
    case ToneScale::linear:
      return std::clamp(share, 0.0, 1.0);
    case ToneScale::gamma:
      return srgb(std::clamp(share, 0.0, 1.0));
    case ToneScale::logarithmic:
      return share > 0 ? std::clamp(1 + std::log10(share) / settings.decades, 0.0, 1.0) : 0;
  }
  return 0;
}

ToneTable::ToneTable(const ToneSettings& settings) {
  const auto entry = [&](double value) {
    if (settings.saturation > 0 && value >= settings.saturation) return kSaturated;
    const Rgb c = colour(settings.map, tone(settings, value));
    return kOpaque | (std::uint32_t{c.red} << 16) | (std::uint32_t{c.green} << 8) | c.blue;
  };
  constexpr std::uint32_t kCount = 0x80000000U >> kShift;
  const std::uint32_t dark = entry(0);
  positive_.resize(kCount);
  negative_.assign(kCount, dark);
  // Beyond white, and far below it, nothing changes any more: only the part between is computed.
  const auto index_of = [](double value) {
    return std::bit_cast<std::uint32_t>(static_cast<float>(value)) >> kShift;
  };
  const double least = settings.is_signed ? settings.white * 1e-4
                       : settings.scale == ToneScale::logarithmic
                           ? settings.white * std::pow(10.0, -settings.decades) * 0.99
                           : settings.white * 1e-6;
  const double top = std::max(settings.white, settings.saturation) * 1.02;
  const std::uint32_t first = std::min(kCount - 1, index_of(least)),
                      last = std::min(kCount - 1, index_of(top));
  std::fill(positive_.begin(), positive_.begin() + first, dark);
  for (std::uint32_t i = first; i <= last; ++i) {
    // The middle of the values that share this entry.
    const auto value =
        static_cast<double>(std::bit_cast<float>((i << kShift) | (1U << (kShift - 1))));
    positive_[i] = entry(value);
    if (settings.is_signed) negative_[i] = entry(-value);
  }
  const std::uint32_t infinite = index_of(std::numeric_limits<double>::infinity());
  for (std::uint32_t i = last + 1; i < kCount; ++i) {
    positive_[i] = i <= infinite ? positive_[last] : dark;
    if (settings.is_signed) negative_[i] = i <= infinite ? negative_[last] : dark;
  }
}

std::uint32_t ToneTable::operator()(float value) const {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return (bits >> 31) != 0 ? negative_[(bits & 0x7fffffffU) >> kShift] : positive_[bits >> kShift];
}

ImagePyramid::ImagePyramid(std::shared_ptr<const Image> image, const Execution& execution) {
  if (!image || image->empty()) return;
  levels_.push_back(std::move(image));
  while (std::max(levels_.back()->width, levels_.back()->height) > kLeastSide)
    levels_.push_back(halved(*levels_.back(), execution));
  std::mutex mutex;
  const Image& first = *levels_.front();
  smallest_ = std::numeric_limits<float>::max();
  largest_ = std::numeric_limits<float>::lowest();
  parallel_for(execution, static_cast<std::size_t>(first.height), [&](std::size_t row, int) {
    float low = std::numeric_limits<float>::max(), high = std::numeric_limits<float>::lowest();
    for (int column = 0; column < first.width; ++column) {
      const float value = first.at(column, static_cast<int>(row));
      if (!std::isfinite(value)) continue;
      low = std::min(low, value);
      high = std::max(high, value);
    }
    const std::lock_guard lock(mutex);
    smallest_ = std::min(smallest_, low);
    largest_ = std::max(largest_, high);
  });
  if (smallest_ > largest_) smallest_ = largest_ = 0;
}

std::size_t ImagePyramid::level_for(double scale) const {
  std::size_t level = 0;
  while (level + 1 < levels_.size() && scale * std::ldexp(1.0, static_cast<int>(level) + 1) <= 1)
    ++level;
  return level;
}

std::size_t ImagePyramid::level_within(int side) const {
  std::size_t level = 0;
  while (level + 1 < levels_.size() &&
         std::max(levels_[level]->width, levels_[level]->height) > side)
    ++level;
  return level;
}

Histogram histogram(const Image& image, int bins, bool logarithmic, double decades) {
  Histogram out;
  out.logarithmic = logarithmic;
  out.counts.assign(static_cast<std::size_t>(bins), 0);
  float low = std::numeric_limits<float>::max(), high = std::numeric_limits<float>::lowest();
  for (const float value : image.pixels)
    if (std::isfinite(value)) {
      low = std::min(low, value);
      high = std::max(high, value);
    }
  if (low > high) return out;
  out.upper = static_cast<double>(high);
  out.lower = logarithmic ? out.upper * std::pow(10.0, -decades) : static_cast<double>(low);
  if (!(out.upper > out.lower)) {
    out.below = static_cast<double>(image.pixels.size());
    return out;
  }
  const double scale = logarithmic ? bins / decades : bins / (out.upper - out.lower);
  for (const float pixel : image.pixels) {
    const auto value = static_cast<double>(pixel);
    if (!std::isfinite(value)) continue;
    if (value < out.lower) {
      out.below += 1;
      continue;
    }
    const double place =
        logarithmic ? std::log10(value / out.lower) * scale : (value - out.lower) * scale;
    out.counts[std::min(static_cast<std::size_t>(place), out.counts.size() - 1)] += 1;
  }
  return out;
}

std::vector<double> line_profile(const Image& image, double x0, double y0, double x1, double y1) {
  const int steps = std::max(1, static_cast<int>(std::lround(std::hypot(x1 - x0, y1 - y0))));
  std::vector<double> values;
  values.reserve(static_cast<std::size_t>(steps) + 1);
  for (int i = 0; i <= steps; ++i) {
    const double t = static_cast<double>(i) / steps;
    const double x = std::floor(x0 + t * (x1 - x0)), y = std::floor(y0 + t * (y1 - y0));
    const bool inside = x >= 0 && y >= 0 && x < image.width && y < image.height;
    values.push_back(inside
                         ? static_cast<double>(image.at(static_cast<int>(x), static_cast<int>(y)))
                         : std::numeric_limits<double>::quiet_NaN());
  }
  return values;
}

}  // namespace plenoflame::desktop
