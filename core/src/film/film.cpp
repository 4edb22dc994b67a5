#include "plenoflame/film/film.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <stdexcept>
#include <utility>

#include "film/image_sums.h"

namespace plenoflame {

Film::Film(PixelWindow window, int channels, int replicates)
    : window_(window),
      channels_(channels),
      replicates_(replicates),
      sums_(static_cast<std::size_t>(tile_count())),
      tile_samples_(static_cast<std::size_t>(tile_count())),
      tile_finished_(static_cast<std::size_t>(tile_count())) {}

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
  if (sums.empty()) {
    if (is_finished(tile)) throw std::logic_error("the sums of a finished tile are gone");
    sums.resize(tile_values(tile));
  }
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
  if (is_finished(tile)) throw std::logic_error("the sums of a finished tile are gone");
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

/// Visits the rows of a tile: where each begins in an image, and in what is kept of the tile.
template <class Visit>
void for_rows(const PixelWindow& tile, const PixelWindow& window, const Visit& visit) {
  for (int row = 0; row < tile.height; ++row)
    visit(
        static_cast<std::size_t>(tile.y - window.y + row) * static_cast<std::size_t>(window.width) +
            static_cast<std::size_t>(tile.x - window.x),
        static_cast<std::size_t>(row) * static_cast<std::size_t>(tile.width));
}

/// The pixels of a tile from one image to the other, both of the same window.
void copy_tile(const Image& from, const PixelWindow& tile, const PixelWindow& window, Image& to) {
  if (from.empty()) return;
  for_rows(tile, window, [&](std::size_t at, std::size_t) {
    std::copy_n(from.pixels.data() + at, tile.width, to.pixels.data() + at);
  });
}

}  // namespace

FilmImages Film::make_images() const {
  FilmImages images;
  images.flux = Image(window_.width, window_.height);
  if (replicates_ > 1) images.standard_error = Image(window_.width, window_.height);
  return images;
}

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
  for_rows(pixels, window_, [&](std::size_t of_image, std::size_t of_tile) {
    estimate(at + of_tile, stride, replicates_, 1 / samples,
             {flux + of_image, static_cast<std::size_t>(pixels.width)},
             error ? error + of_image : nullptr);
  });
}

void Film::allow_finishing() {
  while (finished_.size() < static_cast<std::size_t>(channels_)) finished_.push_back(make_images());
}

void Film::forbid_finishing() {
  if (has_finished_tiles()) throw std::logic_error("tiles of the film are finished");
  finished_.clear();
}

bool Film::has_finished_tiles() const {
  return std::find(tile_finished_.begin(), tile_finished_.end(), 1) != tile_finished_.end();
}

bool Film::is_taken() const {
  return std::any_of(finished_.begin(), finished_.end(),
                     [](const FilmImages& images) { return images.flux.empty(); });
}

void Film::finish(int tile) {
  const auto index = static_cast<std::size_t>(tile);
  std::vector<double>& sums = sums_[index];
  if (!sums.empty()) {  // where nothing came nothing need be kept
    for (int channel = 0; channel < channels_; ++channel)
      develop(tile, channel, finished_.at(static_cast<std::size_t>(channel)));
    tile_finished_[index] = 1;
  }
  sums = {};
}

std::size_t Film::finished_count(int tile) const {
  return tile_values(tile) / static_cast<std::size_t>(replicates_) * (replicates_ > 1 ? 2 : 1);
}

std::vector<float> Film::finished_values(int tile) const {
  if (is_taken()) throw std::logic_error("the pictures of finished tiles are gone");
  std::vector<float> values;
  values.reserve(finished_count(tile));
  const PixelWindow pixels = this->tile(tile);
  for (const FilmImages& images : finished_)
    for (const Image* image : {&images.flux, &images.standard_error})
      if (!image->empty())
        for_rows(pixels, window_, [&](std::size_t at, std::size_t) {
          const auto first = image->pixels.begin() + static_cast<std::ptrdiff_t>(at);
          values.insert(values.end(), first, first + pixels.width);
        });
  return values;
}

void Film::set_finished(int tile, const std::vector<float>& values) {
  if (values.size() != finished_count(tile) || !sums_[static_cast<std::size_t>(tile)].empty())
    throw std::logic_error("not what is kept of an empty tile");
  allow_finishing();
  const float* next = values.data();
  const PixelWindow pixels = this->tile(tile);
  for (FilmImages& images : finished_)
    for (Image* image : {&images.flux, &images.standard_error})
      if (!image->empty())
        for_rows(pixels, window_, [&](std::size_t at, std::size_t) {
          std::copy_n(next, pixels.width, image->pixels.data() + at);
          next += pixels.width;
        });
  tile_finished_[static_cast<std::size_t>(tile)] = 1;
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
  if (is_taken()) throw std::logic_error("the pictures of finished tiles are gone");
  FilmImages images = make_images();
  const Execution inner = execution.threads_only();
  parallel_for(inner, static_cast<std::size_t>(tile_count()), [&](std::size_t index, int) {
    const int tile = static_cast<int>(index);
    if (!is_finished(tile)) return develop(tile, channel, images);
    const FilmImages& finished = finished_[static_cast<std::size_t>(channel)];
    copy_tile(finished.flux, this->tile(tile), window_, images.flux);
    copy_tile(finished.standard_error, this->tile(tile), window_, images.standard_error);
  });
  return images;
}

FilmImages Film::take_images(int channel, const Execution& execution) {
  if (!allows_finishing()) return images(channel, execution);
  FilmImages& finished = finished_[static_cast<std::size_t>(channel)];
  const Execution inner = execution.threads_only();
  parallel_for(inner, static_cast<std::size_t>(tile_count()), [&](std::size_t tile, int) {
    if (!is_finished(static_cast<int>(tile))) develop(static_cast<int>(tile), channel, finished);
  });
  return std::exchange(finished, {});
}

double estimated_relative_rmse(const Image& flux, const Image& standard_error) {
  if (flux.empty() || standard_error.empty()) return 0;
  return stated_error(flux, standard_error, 2).relative_rmse;  // of any number, but not of one
}

}  // namespace plenoflame
