#pragma once
#include <cstddef>
#include <vector>

#include "plenoflame/image/image.h"

namespace plenoflame {

/// What an estimator has gathered: per pixel and channel one sum for each independent
/// randomisation (replicate), in double precision. The mean over replicates is the estimate, their
/// scatter its standard error.
class Film {
 public:
  Film() = default;
  Film(PixelWindow window, int channels, int replicates);

  const PixelWindow& window() const { return window_; }
  int channels() const { return channels_; }
  int replicates() const { return replicates_; }

  /// Sum of one replicate. `column`, `row` count on the whole sensor.
  double& sum(int channel, int replicate, int column, int row) {
    return sums_[index(channel, replicate, column, row)];
  }
  double sum(int channel, int replicate, int column, int row) const {
    return sums_[index(channel, replicate, column, row)];
  }

  /// The film is worked on in tiles of kTile x kTile pixels, from the window's top left corner.
  static constexpr int kTile = 64;
  int tiles_across() const { return (window_.width + kTile - 1) / kTile; }
  int tile_count() const { return tiles_across() * ((window_.height + kTile - 1) / kTile); }
  PixelWindow tile(int index) const;
  /// Samples per replicate that a tile's sums hold.
  double tile_samples(int tile) const { return tile_samples_[static_cast<std::size_t>(tile)]; }
  void add_samples(int tile, double samples) {
    tile_samples_[static_cast<std::size_t>(tile)] += samples;
  }

  /// Estimate and its standard error [W] by each tile's own number of samples; 0 where there are
  /// none.
  Image flux(int channel) const;
  Image standard_error(int channel) const;

  /// All sums and tile counts, in a fixed order: to keep a film in a file and to continue it.
  const std::vector<double>& sums() const { return sums_; }
  std::vector<double>& sums() { return sums_; }
  const std::vector<double>& all_tile_samples() const { return tile_samples_; }
  std::vector<double>& all_tile_samples() { return tile_samples_; }

  /// Estimate [W]: mean of the replicates' sums, divided by `samples` per replicate.
  Image flux(int channel, double samples) const;
  /// Its standard error [W] from the scatter of the replicates; empty with one replicate.
  Image standard_error(int channel, double samples) const;

 private:
  std::size_t index(int channel, int replicate, int column, int row) const {
    return ((static_cast<std::size_t>(row - window_.y) * static_cast<std::size_t>(window_.width) +
             static_cast<std::size_t>(column - window_.x)) *
                static_cast<std::size_t>(channels_) +
            static_cast<std::size_t>(channel)) *
               static_cast<std::size_t>(replicates_) +
           static_cast<std::size_t>(replicate);
  }
  PixelWindow window_;
  int channels_ = 0, replicates_ = 0;
  /// `scale(column, row)` turns a mean of sums into a flux.
  template <class Scale>
  Image flux_scaled(int channel, const Scale& scale) const;
  template <class Scale>
  Image error_scaled(int channel, const Scale& scale) const;
  double tile_scale(int column, int row) const;

  std::vector<double> sums_;
  std::vector<double> tile_samples_;
};

/// Relative RMSE that a flux image has by its own standard errors: root mean square of the errors
/// over the mean flux, over lit pixels (flux above kLitShare of the largest). 0 when nothing is
/// lit.
double estimated_relative_rmse(const Image& flux, const Image& standard_error);

inline constexpr double kLitShare = 0.01;

/// What the standard errors say about the error of a whole image.
struct StatedError {
  double relative_rmse = 0;  ///< best estimate, as estimated_relative_rmse()
  /// The true relative RMSE is below this with a probability of kErrorConfidence (at least: dim
  /// pixels that may be lit count as lit). Infinite with one replicate.
  double bound = 0;
};
inline constexpr double kErrorConfidence = 0.95;

/// @param replicates from whose scatter the standard errors are
StatedError stated_error(const Image& flux, const Image& standard_error, int replicates);

}  // namespace plenoflame
