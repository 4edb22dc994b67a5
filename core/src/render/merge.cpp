#include "plenoflame/render/merge.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "film/image_sums.h"
#include "plenoflame/film/film.h"
#include "plenoflame/film/reopened.h"
#include "render/merge_plan.h"

namespace plenoflame {
namespace {

/// A film without sums, used for its tiling.
Film tiles_of(const PixelWindow& window, int replicates) {
  return {window, 1, replicates};
}

int replicates_of(const LightField& field) {
  return static_cast<int>(field.numbers.at("render.replicates"));
}

/// Copies a rectangle of pixels between images of two windows.
void copy(const Image& from, const PixelWindow& of, const PixelWindow& pixels,
          const PixelWindow& window, Image& to) {
  if (from.empty()) return;
  if (to.empty()) to = Image(window.width, window.height);
  const auto index = [](const PixelWindow& w, int column, int row) {
    return static_cast<std::size_t>(row - w.y) * static_cast<std::size_t>(w.width) +
           static_cast<std::size_t>(column - w.x);
  };
  for (int row = pixels.y; row < pixels.y + pixels.height; ++row)
    std::copy_n(from.pixels.data() + index(of, pixels.x, row), pixels.width,
                to.pixels.data() + index(window, pixels.x, row));
}

/// Copies the pixels of all images of a light field.
void copy(const LightField& from, const PixelWindow& pixels, LightField& to) {
  for (std::size_t c = 0; c < to.channels.size(); ++c) {
    copy(from.channels[c].flux, from.window, pixels, to.window, to.channels[c].flux);
    copy(from.channels[c].standard_error, from.window, pixels, to.window,
         to.channels[c].standard_error);
  }
  for (auto& [name, image] : to.layers)
    copy(from.layers.at(name), from.window, pixels, to.window, image);
}

/// Assembles a picture of one seed. The samples that its files state go to the merged picture's
/// text.
LightField make_mosaic(const std::vector<std::vector<MergePiece>>& windows,
                       const PixelWindow& window, const std::stop_token& stop) {
  LightField all = windows.front().front().header;
  all.window = window;
  all.texts.erase(kPartOfPicture);
  all.texts.erase(kTileSamples);
  const bool single = windows.size() == 1;
  bool differs = false;  // samples differ between windows
  if (!single) all.texts.erase("frame.run");
  for (const auto& parts : windows)
    for (const MergePiece& piece : parts) {
      const LightField file = piece.field ? LightField() : read_light_field(piece.path, stop);
      const LightField& part = piece.field ? *piece.field : file;
      const bool has_text = part.texts.contains(kTileSamples);
      differs = differs || part.samples != all.samples || part.texts.contains(kMergedPicture) ||
                (has_text && piece.part.is_whole());
      all.samples = std::max(all.samples, part.samples);
      Film tiles = tiles_of(part.window, replicates_of(part));
      for (int t = 0; t < tiles.tile_count(); ++t)
        if (part_of_tile(t, tiles.tiles_across(), piece.part.count) == piece.part.number - 1)
          copy(part, tiles.tile(t), all);
    }
  if (!single && differs) all.texts[kMergedPicture] = "windows";
  if (!single) return all;
  Film tiles = tiles_of(window, replicates_of(all));
  bool has_text = false;
  for (const MergePiece& piece : windows.front()) {
    has_text = has_text || piece.header.texts.contains(kTileSamples);
    const std::vector<double> samples =
        tile_samples_of(piece.header, tiles.replicates(), tiles.tile_count());
    for (int t = 0; t < tiles.tile_count(); ++t)
      if (part_of_tile(t, tiles.tiles_across(), piece.part.count) == piece.part.number - 1)
        tiles.add_samples(t, samples[static_cast<std::size_t>(t)]);
  }
  if (const std::string text = tile_samples_text(tiles); has_text && !text.empty())
    all.texts[kTileSamples] = text;
  return all;
}

/// The weighted mean of independent pictures, and its standard error.
class Mean {
 public:
  explicit Mean(const PixelWindow& window) : tiles_(tiles_of(window, 1)) {}

  void add(const LightField& picture) {
    const int replicates = replicates_of(picture);
    // A picture without an entry for its tiles has the same samples everywhere.
    std::vector<double> samples = tile_samples_of(picture, replicates, tiles_.tile_count());
    sums_.resize(picture.channels.size());
    for (std::size_t c = 0; c < sums_.size(); ++c) {
      const LightFieldChannel& channel = picture.channels[c];
      sums_[c].flux.resize(channel.flux.pixels.size());
      sums_[c].variance.resize(channel.standard_error.pixels.size());
      for (int t = 0; t < tiles_.tile_count(); ++t)
        add(channel, tiles_.tile(t), replicates * samples[static_cast<std::size_t>(t)], sums_[c]);
    }
    for (int t = 0; t < tiles_.tile_count(); ++t)
      tiles_.add_samples(t, replicates * samples[static_cast<std::size_t>(t)]);
    freedom_ += replicates - 1;
    samples_ += picture.samples;
  }

  void put(LightField& picture) const {
    for (std::size_t c = 0; c < sums_.size(); ++c)
      for (int t = 0; t < tiles_.tile_count(); ++t) {
        const double samples = tiles_.tile_samples(t);
        for_pixels(tiles_.tile(t), [&](std::size_t i) {
          LightFieldChannel& channel = picture.channels[c];
          channel.flux.pixels[i] =
              samples > 0 ? static_cast<float>(sums_[c].flux[i] / samples) : 0.0F;
          if (!sums_[c].variance.empty())
            channel.standard_error.pixels[i] =
                samples > 0 ? static_cast<float>(std::sqrt(sums_[c].variance[i]) / samples) : 0.0F;
        });
      }
    picture.samples = samples_;
    // The number of replicates whose scatter would be known equally well.
    picture.numbers["render.replicates"] = freedom_ + 1;
  }

 private:
  struct Sums {
    std::vector<double> flux, variance;  ///< flux times samples, and its variance
  };

  template <class Use>
  void for_pixels(const PixelWindow& tile, const Use& use) const {
    const PixelWindow& w = tiles_.window();
    for (int row = tile.y - w.y; row < tile.y - w.y + tile.height; ++row)
      for (int column = tile.x - w.x; column < tile.x - w.x + tile.width; ++column)
        use(static_cast<std::size_t>(row) * static_cast<std::size_t>(w.width) +
            static_cast<std::size_t>(column));
  }
  void add(const LightFieldChannel& channel, const PixelWindow& tile, double samples,
           Sums& sums) const {
    for_pixels(tile, [&](std::size_t i) {
      sums.flux[i] += samples * static_cast<double>(channel.flux.pixels[i]);
      if (sums.variance.empty()) return;
      const double error = samples * static_cast<double>(channel.standard_error.pixels[i]);
      sums.variance[i] += error * error;
    });
  }

  Film tiles_;
  std::vector<Sums> sums_;  ///< one per channel
  double freedom_ = 0, samples_ = 0;
};

/// The energy is the sum over the picture; it is computed as render() does.
void put_energy(LightField& picture) {
  const auto time = picture.numbers.find("exposure.time");
  const auto energy = picture.numbers.find("exposure.energy");
  if (time == picture.numbers.end() || energy == picture.numbers.end()) return;
  const Image& flux = picture.channels.front().flux;
  double sum = 0;
  if (picture.numbers.contains("exposure.moments")) {
    for (const float value : flux.pixels) sum += static_cast<double>(value);
  } else {
    const Film tiles = tiles_of(picture.window, 1);
    ImageParts parts;
    for (int t = 0; t < tiles.tile_count(); ++t) {
      parts.push_back(tiles.tile(t));
      parts.back().x -= picture.window.x;
      parts.back().y -= picture.window.y;
    }
    sum = sum_of(flux, parts, {});
  }
  energy->second = sum * time->second;
}

}  // namespace

LightField merge_light_fields(const std::vector<std::string>& paths, const std::stop_token& stop,
                              MergeCounts* counts) {
  std::vector<MergeInput> files;
  for (const std::string& path : paths) files.push_back({path, nullptr});
  return merge_light_fields(files, stop, counts);
}

LightField merge_light_fields(const std::vector<MergeInput>& pictures, const std::stop_token& stop,
                              MergeCounts* counts) {
  const MergePlan plan = make_merge_plan(pictures);
  LightField all;
  Mean mean(plan.window);
  std::string seeds;
  for (const auto& [seed, windows] : plan.seeds) {
    LightField one = make_mosaic(windows, plan.window, stop);
    seeds += (seeds.empty() ? "seeds " : " ") + std::to_string(seed);
    if (plan.seeds.size() > 1) mean.add(one);
    if (all.channels.empty()) all = std::move(one);
  }
  if (plan.seeds.size() > 1) {
    mean.put(all);
    for (const char* key : {kTileSamples, "frame.run"}) all.texts.erase(key);
    all.texts[kMergedPicture] = seeds;
  }
  put_energy(all);
  if (!counts) return all;
  *counts = {};
  counts->seeds = plan.seeds.size();
  for (const auto& [seed, windows] : plan.seeds) {
    counts->windows = std::max(counts->windows, windows.size());
    for (const auto& parts : windows) counts->parts = std::max(counts->parts, parts.size());
  }
  return all;
}

}  // namespace plenoflame
