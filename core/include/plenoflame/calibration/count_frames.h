#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "plenoflame/image/image.h"
#include "plenoflame/image/raw_picture.h"

namespace plenoflame {

/// Frames of one series, pixel by pixel: their mean and how much they scatter.
struct CountFrames {
  int width = 0, height = 0;
  int bits = 0;                     ///< that a number may have
  int frames = 0;                   ///< number of them
  std::vector<Image> mean;          ///< [counts] one for each channel of the pictures
  std::vector<Image> variance;      ///< [counts^2] of a single frame; empty for one frame
  std::vector<std::uint8_t> state;  ///< of each pixel, PixelState; of the worst channel and frame
  std::size_t saturated = 0;        ///< pixels
  int common_shift = 0;             ///< all numbers of all frames are multiples of 2 to this power

  std::size_t pixel_count() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
};

/// Adds frame after frame; memory holds sums, not frames.
class FrameSums {
 public:
  /// @param saturation a pixel that reaches this number of counts is full; 0: the largest number
  ///        that its bits allow
  explicit FrameSums(double saturation = 0) : saturation_(saturation) {}
  /// @param what names the picture in messages @throws InputError: not the size, channels or bits
  /// of those before
  void add(const RawPicture& picture, const std::string& what);
  bool empty() const { return frames_ == 0; }
  /// @throws InputError without frames
  CountFrames result() const;

 private:
  double saturation_;
  int width_ = 0, height_ = 0, channels_ = 0, bits_ = 0, frames_ = 0;
  std::uint16_t used_bits_ = 0;
  std::vector<std::uint16_t> first_;
  std::vector<double> sum_, square_;  ///< of differences from the first frame
  std::vector<std::uint8_t> state_;
};

/// Variance of a sensor's counts as a function of their mean: variance = floor + slope * mean. The
/// mean is above the dark level; 1 / slope is the gain [electrons per count] (photon transfer;
/// Janesick, Photon Transfer, SPIE 2007, chapter 5).
struct PhotonTransfer {
  double floor = 0;        ///< [counts^2] of dark pixels: read noise and rounding
  double slope = 0;        ///< [counts]
  double slope_error = 0;  ///< its standard error
  double excess = 0;       ///< reduced chi-square of the fit; 1 is expected of a linear relation
};

/// Fits it to the scatter of a series over all good pixels. The fit uses means over groups of
/// equally bright pixels, weighted by their expected errors. Medians would be biased.
/// @param dark [counts] of each pixel, or its level where the image is empty
/// @throws InputError: fewer than two frames, or pixels all of one brightness
PhotonTransfer fit_photon_transfer(const CountFrames& series, std::size_t channel,
                                   const Image& dark, double dark_level);

}  // namespace plenoflame
