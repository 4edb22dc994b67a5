#include "plenoflame/film/film.h"

#include <algorithm>
#include <cmath>

#include "film/image_sums.h"

namespace plenoflame {

Film::Film(PixelWindow window, int channels, int replicates)
    : window_(window),
      channels_(channels),
      replicates_(replicates),
      sums_(static_cast<std::size_t>(tile_count())),
      tile_samples_(static_cast<std::size_t>(tile_count())) {}

PixelWindow Film::tile(int index) const {
  const int x = index % tiles_across() * kTile, y = index / tiles_across() * kTile;
  return {window_.x + x, window_.y + y, std::min(kTile, window_.width - x),
          std::min(kTile, window_.height - y)};
}

std::size_t Film::tile_values(int tile) const {
  const PixelWindow pixels = this->tile(tile);
  return static_cast<std::size_t>(pixels.width) * static_cast<std::size_t>(pixels.height) *
         static_cast<std::size_t>(channels_) * static_cast<std::size_t>(replicates_);
}

std::vector<double>& Film::tile_sums(int tile) {
  std::vector<double>& sums = sums_[static_cast<std::size_t>(tile)];
  if (sums.empty()) sums.resize(tile_values(tile));
  return sums;
}

std::size_t Film::index_in_tile(int tile, int channel, int replicate, int column, int row) const {
  const PixelWindow pixels = this->tile(tile);
  const auto pixel =
      static_cast<std::size_t>(row - pixels.y) * static_cast<std::size_t>(pixels.width) +
      static_cast<std::size_t>(column - pixels.x);
  return (pixel * static_cast<std::size_t>(channels_) + static_cast<std::size_t>(channel)) *
             static_cast<std::size_t>(replicates_) +
         static_cast<std::size_t>(replicate);
}

double& Film::sum(int channel, int replicate, int column, int row) {
  const int tile = tile_of(column, row);
  return tile_sums(tile)[index_in_tile(tile, channel, replicate, column, row)];
}

double Film::sum(int channel, int replicate, int column, int row) const {
  const int tile = tile_of(column, row);
  const std::vector<double>& sums = tile_sums(tile);
  return sums.empty() ? 0 : sums[index_in_tile(tile, channel, replicate, column, row)];
}

void Film::develop(int tile, int channel, FilmImages& images) const {
  const std::vector<double>& sums = tile_sums(tile);
  const double samples = tile_samples(tile);
  if (!is_lit(tile)) return;
  const PixelWindow pixels = this->tile(tile);
  const double scale = 1.0 / samples, n = replicates_;
  const auto replicates = static_cast<std::size_t>(replicates_);
  const std::size_t stride = static_cast<std::size_t>(channels_) * replicates;
  const double* at = sums.data() + static_cast<std::size_t>(channel) * replicates;
  for (int row = pixels.y - window_.y; row < pixels.y - window_.y + pixels.height; ++row)
    for (int column = pixels.x - window_.x; column < pixels.x - window_.x + pixels.width;
         ++column, at += stride) {
      double total = 0;
      for (std::size_t r = 0; r < replicates; ++r) total += at[r];
      const double mean = total / n;
      images.flux.at(column, row) = static_cast<float>(mean * scale);
      if (replicates_ < 2) continue;
      double squares = 0;
      for (std::size_t r = 0; r < replicates; ++r) squares += (at[r] - mean) * (at[r] - mean);
      images.standard_error.at(column, row) =
          static_cast<float>(std::sqrt(squares / (n * (n - 1))) * scale);
    }
}

std::vector<PixelWindow> Film::lit_parts() const {
  std::vector<PixelWindow> parts;
  for (int tile = 0; tile < tile_count(); ++tile) {
    if (!is_lit(tile)) continue;
    parts.push_back(this->tile(tile));
    parts.back().x -= window_.x;
    parts.back().y -= window_.y;
  }
  return parts;
}

FilmImages Film::images(int channel, const Execution& execution) const {
  FilmImages images;
  // What has been gathered is wanted also after a stop.
  Execution inner;
  inner.threads = execution.threads;
  images.flux = Image(window_.width, window_.height);
  if (replicates_ > 1) images.standard_error = Image(window_.width, window_.height);
  parallel_for(inner, static_cast<std::size_t>(tile_count()),
               [&](std::size_t tile, int) { develop(static_cast<int>(tile), channel, images); });
  return images;
}

double estimated_relative_rmse(const Image& flux, const Image& standard_error) {
  if (flux.empty() || standard_error.empty()) return 0;
  return stated_error(flux, standard_error, 2).relative_rmse;  // of any number, but not of one
}

}  // namespace plenoflame
