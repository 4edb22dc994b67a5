#pragma once
#include <cstddef>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/image/image.h"

namespace plenoflame {

/// A channel as pictures of the film's window.
struct FilmImages {
  Image flux;            ///< [W]
  Image standard_error;  ///< [W] by the scatter of the replicates; empty with one replicate

  friend bool operator==(const FilmImages&, const FilmImages&) = default;
};

/// The sums that an estimator has gathered: for each pixel and channel one sum per replicate
/// (independent repetition), in double precision. Up to 8 rays are first summed in their own
/// precision. The mean over replicates is the estimate; their scatter gives its standard error.
/// Tiles without light take no memory.
class Film {
 public:
  Film() = default;
  Film(PixelWindow window, int channels, int replicates);

  const PixelWindow& window() const { return window_; }
  int channels() const { return channels_; }
  int replicates() const { return replicates_; }

  /// The film is kept and worked on in tiles of kTile x kTile pixels, from the window's top left
  /// corner. Different threads may work on different tiles.
  static constexpr int kTile = 64;
  int tiles_across() const { return (window_.width + kTile - 1) / kTile; }
  int tile_count() const { return tiles_across() * ((window_.height + kTile - 1) / kTile); }
  /// Pixels of a tile, counted on the whole sensor.
  PixelWindow tile(int index) const;
  /// Samples per replicate that a tile's sums hold.
  double tile_samples(int tile) const { return tile_samples_[static_cast<std::size_t>(tile)]; }
  void add_samples(int tile, double samples) {
    tile_samples_[static_cast<std::size_t>(tile)] += samples;
  }

  /// Sums of a tile, ordered by channel, replicate and pixel (row by row). The first call allocates
  /// zeros; empty before.
  std::vector<double>& tile_sums(int tile);
  const std::vector<double>& tile_sums(int tile) const {
    return sums_[static_cast<std::size_t>(tile)];
  }
  /// The sums of a tile were moved elsewhere: it holds nothing again.
  void tile_sums_taken(int tile) {
    sums_[static_cast<std::size_t>(tile)] = {};
    tile_samples_[static_cast<std::size_t>(tile)] = 0;
  }
  std::size_t tile_values(int tile) const;  ///< how many sums a tile has

  /// Sum of one replicate. `column`, `row` count on the whole sensor.
  double& sum(int channel, int replicate, int column, int row);
  double sum(int channel, int replicate, int column, int row) const;

  /// Estimate and its standard error by each tile's own number of samples; 0 where there are none.
  FilmImages images(int channel, const Execution& execution = {}) const;

  /// The tiles, from the corner of such an image, that hold light. Outside of them every channel is
  /// 0.
  std::vector<PixelWindow> lit_parts() const;

  /// Samples per replicate that the round in progress brings each tile to: what has been decided
  /// goes with what has been gathered. Empty as long as nothing has.
  const std::vector<double>& tile_goals() const { return tile_goals_; }
  std::vector<double>& tile_goals() { return tile_goals_; }

  /// Samples of all tiles: to keep a film in a file and to continue it.
  const std::vector<double>& all_tile_samples() const { return tile_samples_; }
  std::vector<double>& all_tile_samples() { return tile_samples_; }

  friend bool operator==(const Film&, const Film&) = default;

 private:
  int tile_of(int column, int row) const {
    return (row - window_.y) / kTile * tiles_across() + (column - window_.x) / kTile;
  }
  std::size_t index_in_tile(int tile, int channel, int replicate, int column, int row) const;
  bool is_lit(int tile) const { return !tile_sums(tile).empty() && tile_samples(tile) > 0; }
  void develop(int tile, int channel, FilmImages& images) const;

  PixelWindow window_;
  int channels_ = 0, replicates_ = 0;
  std::vector<std::vector<double>> sums_;
  std::vector<double> tile_samples_, tile_goals_;
};

/// Relative RMSE that a flux image has by its own standard errors: root mean square of the errors
/// over the mean flux. Both are over lit pixels (flux above kLitShare of the largest). 0 if no
/// pixel is lit.
double estimated_relative_rmse(const Image& flux, const Image& standard_error);

inline constexpr double kLitShare = 0.01;

/// The error of a whole image, by its standard errors.
struct StatedError {
  double relative_rmse = 0;  ///< best estimate, as estimated_relative_rmse()
  /// The true relative RMSE is below this with a probability of about kErrorConfidence, which is
  /// no guarantee. If one pixel makes most of it and there are two replicates, the probability is
  /// only 82 to 84 % (docs/theory/errors.md). One replicate: infinite.
  double bound = 0;
};
inline constexpr double kErrorConfidence = 0.95;

/// @param replicates from whose scatter the standard errors are
StatedError stated_error(const Image& flux, const Image& standard_error, int replicates);

}  // namespace plenoflame
