#include "plenoflame/film/film.h"

#include <algorithm>
#include <cmath>

namespace plenoflame {

Film::Film(PixelWindow window, int channels, int replicates)
    : window_(window),
      channels_(channels),
      replicates_(replicates),
      sums_(static_cast<std::size_t>(window.width) * static_cast<std::size_t>(window.height) *
            static_cast<std::size_t>(channels) * static_cast<std::size_t>(replicates)),
      tile_samples_(static_cast<std::size_t>(tile_count())) {}

PixelWindow Film::tile(int index) const {
  const int x = index % tiles_across() * kTile, y = index / tiles_across() * kTile;
  return {window_.x + x, window_.y + y, std::min(kTile, window_.width - x),
          std::min(kTile, window_.height - y)};
}

double Film::tile_scale(int column, int row) const {
  const double samples = tile_samples(row / kTile * tiles_across() + column / kTile);
  return samples > 0 ? 1.0 / samples : 0.0;
}

template <class Scale>
Image Film::flux_scaled(int channel, const Scale& scale) const {
  Image image(window_.width, window_.height);
  for (int row = 0; row < window_.height; ++row)
    for (int column = 0; column < window_.width; ++column) {
      double total = 0;
      for (int r = 0; r < replicates_; ++r)
        total += sum(channel, r, column + window_.x, row + window_.y);
      image.at(column, row) = static_cast<float>(total / replicates_ * scale(column, row));
    }
  return image;
}

template <class Scale>
Image Film::error_scaled(int channel, const Scale& scale) const {
  if (replicates_ < 2) return {};
  Image image(window_.width, window_.height);
  for (int row = 0; row < window_.height; ++row)
    for (int column = 0; column < window_.width; ++column) {
      double mean = 0;
      for (int r = 0; r < replicates_; ++r)
        mean += sum(channel, r, column + window_.x, row + window_.y);
      mean /= replicates_;
      double squares = 0;
      for (int r = 0; r < replicates_; ++r) {
        const double d = sum(channel, r, column + window_.x, row + window_.y) - mean;
        squares += d * d;
      }
      image.at(column, row) = static_cast<float>(
          std::sqrt(squares / (static_cast<double>(replicates_) * (replicates_ - 1))) *
          scale(column, row));
    }
  return image;
}

Image Film::flux(int channel, double samples) const {
  return flux_scaled(channel, [=](int, int) { return 1.0 / samples; });
}

Image Film::standard_error(int channel, double samples) const {
  return error_scaled(channel, [=](int, int) { return 1.0 / samples; });
}

Image Film::flux(int channel) const {
  return flux_scaled(channel, [this](int column, int row) { return tile_scale(column, row); });
}

Image Film::standard_error(int channel) const {
  return error_scaled(channel, [this](int column, int row) { return tile_scale(column, row); });
}

double estimated_relative_rmse(const Image& flux, const Image& standard_error) {
  if (flux.empty() || standard_error.empty()) return 0;
  const float limit =
      static_cast<float>(kLitShare) * *std::max_element(flux.pixels.begin(), flux.pixels.end());
  double squares = 0, total = 0, count = 0;
  for (std::size_t i = 0; i < flux.pixels.size(); ++i) {
    if (!(flux.pixels[i] > limit)) continue;
    const double error = static_cast<double>(standard_error.pixels[i]);
    squares += error * error;
    total += static_cast<double>(flux.pixels[i]);
    count += 1;
  }
  return count > 0 ? std::sqrt(squares / count) / (total / count) : 0;
}

}  // namespace plenoflame
