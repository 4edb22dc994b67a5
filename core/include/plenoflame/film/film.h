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
  std::vector<double> sums_;
};

/// Relative RMSE that a flux image has by its own standard errors: root mean square of the errors
/// over the mean flux, over lit pixels (flux above kLitShare of the largest). 0 when nothing is lit.
double estimated_relative_rmse(const Image& flux, const Image& standard_error);

inline constexpr double kLitShare = 0.01;

}  // namespace plenoflame
