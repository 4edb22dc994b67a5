#include "plenoflame/calibration/count_frames.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "plenoflame/base/error.h"

namespace plenoflame {

void FrameSums::add(const RawPicture& picture, const std::string& what) {
  const std::size_t pixels = picture.pixel_count();
  const auto channels = static_cast<std::size_t>(picture.channels);
  if (frames_ == 0) {
    width_ = picture.width;
    height_ = picture.height;
    channels_ = picture.channels;
    bits_ = picture.bits;
    state_.assign(pixels, 0);
    first_ = picture.samples;
  } else if (picture.width != width_ || picture.height != height_) {
    throw InputError(what + " has " + std::to_string(picture.width) + " x " +
                     std::to_string(picture.height) + " pixels, the one before " +
                     std::to_string(width_) + " x " + std::to_string(height_) +
                     ": frames of a series have one size");
  } else if (picture.channels != channels_ || picture.bits != bits_) {
    throw InputError(what + " has " + std::to_string(picture.channels) + " channels of " +
                     std::to_string(picture.bits) + " bits, the one before " +
                     std::to_string(channels_) + " of " + std::to_string(bits_) +
                     ": frames of a series are of one kind");
  }
  ++frames_;
  const double full = saturation_ > 0 ? saturation_ : std::ldexp(1.0, bits_) - 1;
  // Sums are of differences from the first frame, so that nothing is lost where counts are large
  // and alike.
  if (frames_ == 2) {
    sum_.assign(first_.size(), 0);
    square_.assign(first_.size(), 0);
  }
  for (std::size_t i = 0; i < pixels; ++i)
    for (std::size_t c = 0; c < channels; ++c) {
      const std::size_t at = i * channels + c;
      const std::uint16_t value = picture.samples[at];
      used_bits_ = static_cast<std::uint16_t>(used_bits_ | value);
      if (value >= full) state_[i] = static_cast<std::uint8_t>(PixelState::saturated);
      if (frames_ == 1) continue;
      const double difference = static_cast<double>(value) - first_[at];
      sum_[at] += difference;
      square_[at] += difference * difference;
    }
}

CountFrames FrameSums::result() const {
  if (frames_ == 0) throw InputError("there is no frame");
  CountFrames out;
  out.width = width_;
  out.height = height_;
  out.bits = bits_;
  out.frames = frames_;
  out.state = state_;
  // Numbers of up to 12 bits may well be even by chance of the scene.
  out.common_shift = std::bit_width(used_bits_) > 12 ? std::countr_zero(used_bits_) : 0;
  const auto channels = static_cast<std::size_t>(channels_);
  const std::size_t pixels = out.pixel_count();
  out.mean.assign(channels, Image(width_, height_));
  if (frames_ > 1) out.variance.assign(channels, Image(width_, height_));
  for (std::size_t i = 0; i < pixels; ++i)
    for (std::size_t c = 0; c < channels; ++c) {
      const std::size_t at = i * channels + c;
      const double shift = frames_ > 1 ? sum_[at] / frames_ : 0;
      out.mean[c].pixels[i] = static_cast<float>(first_[at] + shift);
      if (frames_ > 1)
        out.variance[c].pixels[i] = static_cast<float>(
            std::max(0.0, square_[at] - frames_ * shift * shift) / (frames_ - 1));
    }
  out.saturated = static_cast<std::size_t>(
      std::count_if(state_.begin(), state_.end(), [](std::uint8_t state) { return state != 0; }));
  return out;
}

PhotonTransfer fit_photon_transfer(const CountFrames& series, std::size_t channel,
                                   const Image& dark, double dark_level) {
  if (series.frames < 2)
    throw InputError("how noise depends on brightness takes two frames of one scene or more");
  struct Group {
    double mean = 0, variance = 0;
    std::size_t count = 0;
  };
  const Image& mean = series.mean.at(channel);
  const Image& variance = series.variance.at(channel);
  const auto above_dark = [&](std::size_t i) {
    return static_cast<double>(mean.pixels[i]) -
           (dark.empty() ? dark_level : static_cast<double>(dark.pixels[i]));
  };
  double brightest = 0;
  for (std::size_t i = 0; i < mean.pixels.size(); ++i)
    if (series.state[i] == 0) brightest = std::max(brightest, above_dark(i));
  constexpr int kGroups = 64;
  std::vector<Group> groups(kGroups);
  for (std::size_t i = 0; i < mean.pixels.size() && brightest > 0; ++i) {
    if (series.state[i] != 0) continue;
    const double m = above_dark(i);
    // Pixels are sorted by a mean that holds their own noise; groups are wide against that.
    const int g = std::clamp(static_cast<int>(m / brightest * kGroups), 0, kGroups - 1);
    Group& group = groups[static_cast<std::size_t>(g)];
    group.mean += m;
    group.variance += static_cast<double>(variance.pixels[i]);
    ++group.count;
  }
  std::erase_if(groups, [](const Group& group) { return group.count < 20; });
  if (groups.size() < 3)
    throw InputError(
        "the pixels are all of about one brightness, so that their noise does not tell the gain");
  for (Group& group : groups) {
    group.mean /= static_cast<double>(group.count);
    group.variance /= static_cast<double>(group.count);
  }
  PhotonTransfer fit;
  std::vector<double> expected;
  for (const Group& group : groups) expected.push_back(std::max(group.variance, 1e-12));
  for (int round = 0; round < 5; ++round) {
    double s = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      // Variance of a mean of sample variances: 2 v^2 / ((n - 1) count).
      const double w = (series.frames - 1.0) * static_cast<double>(groups[g].count) /
                       (2 * expected[g] * expected[g]);
      s += w;
      sx += w * groups[g].mean;
      sy += w * groups[g].variance;
      sxx += w * groups[g].mean * groups[g].mean;
      sxy += w * groups[g].mean * groups[g].variance;
    }
    const double determinant = s * sxx - sx * sx;
    if (!(determinant > 0)) throw InputError("the pixels are all of one brightness");
    fit.slope = (s * sxy - sx * sy) / determinant;
    fit.floor = (sxx * sy - sx * sxy) / determinant;
    fit.slope_error = std::sqrt(s / determinant);
    fit.excess = 0;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const double w = (series.frames - 1.0) * static_cast<double>(groups[g].count) /
                       (2 * expected[g] * expected[g]);
      const double off = groups[g].variance - fit.floor - fit.slope * groups[g].mean;
      fit.excess += w * off * off / static_cast<double>(groups.size() - 2);
    }
    for (std::size_t g = 0; g < groups.size(); ++g)
      expected[g] =
          std::max(fit.floor + fit.slope * groups[g].mean, 0.05 * groups[g].variance + 1e-12);
  }
  return fit;
}

}  // namespace plenoflame
