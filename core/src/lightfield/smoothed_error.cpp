#include "plenoflame/lightfield/smoothed_error.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace plenoflame {
namespace {

constexpr std::size_t kGroups = 32, kLeastValues = 64;

/// Mean of each pixel and its neighbours: light that chance left out of a pixel is in theirs.
Image mean_around(const Image& flux) {
  Image mean(flux.width, flux.height);
  for (int row = 0; row < flux.height; ++row)
    for (int column = 0; column < flux.width; ++column) {
      double sum = 0;
      int count = 0;
      for (int y = std::max(0, row - 1); y <= std::min(flux.height - 1, row + 1); ++y)
        for (int x = std::max(0, column - 1); x <= std::min(flux.width - 1, column + 1); ++x)
          if (std::isfinite(flux.at(x, y))) sum += static_cast<double>(flux.at(x, y)), ++count;
      mean.at(column, row) = count > 0 ? static_cast<float>(sum / count) : 0;
    }
  return mean;
}

}  // namespace

std::vector<std::pair<double, double>> errors_by_brightness(
    std::vector<std::pair<double, double>> values) {
  std::sort(values.begin(), values.end());
  const std::size_t groups = std::clamp<std::size_t>(values.size() / kLeastValues, 1, kGroups);
  std::vector<std::pair<double, double>> result;
  for (std::size_t g = 0; g < groups; ++g) {
    const std::size_t begin = values.size() * g / groups, end = values.size() * (g + 1) / groups;
    double light = 0, variance = 0;
    for (std::size_t i = begin; i < end; ++i) {
      light += values[i].first * values[i].first;
      variance += values[i].second * values[i].second;
    }
    const auto count = static_cast<double>(end - begin);
    const double brightness = std::sqrt(light / count);
    if (result.empty() || brightness > result.back().first)
      result.emplace_back(brightness, std::sqrt(variance / count));
  }
  return result;
}

Image smoothed_error(const Image& flux, const Image& error) {
  Image result(flux.width, flux.height);
  const Image around = mean_around(flux);
  std::vector<std::pair<double, double>> lit;
  for (std::size_t i = 0; i < around.pixels.size(); ++i)
    if (around.pixels[i] > 0 && std::isfinite(error.pixels[i]))
      lit.emplace_back(around.pixels[i], error.pixels[i]);
  if (lit.empty()) return result;
  const std::vector<std::pair<double, double>> knots = errors_by_brightness(std::move(lit));
  for (std::size_t i = 0; i < around.pixels.size(); ++i) {
    const auto value = static_cast<double>(around.pixels[i]);
    const auto above = std::upper_bound(
        knots.begin(), knots.end(), value,
        [](double f, const std::pair<double, double>& knot) { return f < knot.first; });
    double smooth = above == knots.begin() ? knots.front().second : knots.back().second;
    if (above != knots.begin() && above != knots.end()) {
      const auto& [f0, e0] = *(above - 1);
      const double share = (value - f0) / (above->first - f0);
      smooth = e0 + share * (above->second - e0);
    }
    result.pixels[i] = static_cast<float>(smooth);
  }
  return result;
}

}  // namespace plenoflame
