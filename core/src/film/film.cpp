#include "plenoflame/film/film.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

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
  const auto width = static_cast<std::size_t>(pixels.width);
  const auto pixel = static_cast<std::size_t>(row - pixels.y) * width +
                     static_cast<std::size_t>(column - pixels.x);
  return static_cast<std::size_t>(channel * replicates_ + replicate) * width *
             static_cast<std::size_t>(pixels.height) +
         pixel;
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

namespace {

/// Flux and standard error of neighbouring pixels.
/// @param at the first one's sum of the first replicate @param stride from one replicate to the
/// next
void estimate(const double* at, std::size_t stride, int replicates, double scale,
              std::span<float> flux, float* standard_error) {
  std::array<double, Film::kTile> mean{}, squares{};
  const std::size_t pixels = flux.size();
  const double n = replicates;
  for (int r = 0; r < replicates; ++r)
    for (std::size_t i = 0; i < pixels; ++i)
      mean[i] += at[static_cast<std::size_t>(r) * stride + i];
  for (std::size_t i = 0; i < pixels; ++i) mean[i] /= n;
  for (std::size_t i = 0; i < pixels; ++i) flux[i] = static_cast<float>(mean[i] * scale);
  if (replicates < 2) return;
  for (int r = 0; r < replicates; ++r)
    for (std::size_t i = 0; i < pixels; ++i) {
      const double off = at[static_cast<std::size_t>(r) * stride + i] - mean[i];
      squares[i] += off * off;
    }
  const double part = 1 / (n * (n - 1));
  for (std::size_t i = 0; i < pixels; ++i)
    standard_error[i] = static_cast<float>(std::sqrt(squares[i] * part) * scale);
}

}  // namespace

/// Writes the tile's pixels, unless nothing came.
void Film::develop(int tile, int channel, FilmImages& images) const {
  const std::vector<double>& sums = tile_sums(tile);
  const double samples = tile_samples(tile);
  if (sums.empty() || !(samples > 0)) return;
  const PixelWindow pixels = this->tile(tile);
  const std::size_t stride =
      static_cast<std::size_t>(pixels.width) * static_cast<std::size_t>(pixels.height);
  const double* at = sums.data() + static_cast<std::size_t>(channel) *
                                       static_cast<std::size_t>(replicates_) * stride;
  float* const flux = images.flux.pixels.data();
  float* const error = images.standard_error.pixels.data();
  const auto width = static_cast<std::size_t>(pixels.width);
  for (int row = 0; row < pixels.height; ++row, at += width) {
    const std::size_t of_image = static_cast<std::size_t>(pixels.y - window_.y + row) *
                                     static_cast<std::size_t>(window_.width) +
                                 static_cast<std::size_t>(pixels.x - window_.x);
    estimate(at, stride, replicates_, 1 / samples, {flux + of_image, width},
             error ? error + of_image : nullptr);
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
  images.flux = Image(window_.width, window_.height);
  if (replicates_ > 1) images.standard_error = Image(window_.width, window_.height);
  const Execution inner = execution.threads_only();
  parallel_for(inner, static_cast<std::size_t>(tile_count()),
               [&](std::size_t tile, int) { develop(static_cast<int>(tile), channel, images); });
  return images;
}

double estimated_relative_rmse(const Image& flux, const Image& standard_error) {
  if (flux.empty() || standard_error.empty()) return 0;
  return stated_error(flux, standard_error, 2).relative_rmse;  // of any number, but not of one
}

}  // namespace plenoflame
