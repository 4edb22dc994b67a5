#pragma once
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "plenoflame/render/ray_stream.h"
#include "plenoflame/render/render.h"

namespace plenoflame::test {

/// A picture of the settings' window, made from the stream of its rays as a user would.
template <class Real>
class StreamPicture {
 public:
  StreamPicture(const CompiledScene& scene, const RenderSettings& settings,
                const Execution& execution, RayStreamContent content)
      : window_(settings.window),
        options_{settings.isa, settings.skip},
        replicates_(static_cast<std::size_t>(settings.replicates)),
        sums_(scene.scene.channels.size() * replicates_,
              std::vector<double>(static_cast<std::size_t>(window_.width * window_.height))) {
    // A pixel's rays belong to one tile, and so to one worker: no lock.
    const RayBlockConsumer<Real> add = [&](const RayBlock<Real>& block, int) {
      if (content == RayStreamContent::radiance)
        add_rays(block, block.radiance.data());
      else
        add_rays(block, integrate(block).data());
    };
    EXPECT_TRUE(stream_rays<Real>(scene, settings, execution, add, content));
    for (std::size_t c = 0; c < scene.scene.channels.size(); ++c) add_replicates(c);
  }

  /// [W] row by row.
  const std::vector<double>& flux(std::size_t channel) const { return flux_[channel]; }
  /// [W] by the scatter of the replicates.
  const std::vector<double>& standard_error(std::size_t channel) const { return error_[channel]; }

 private:
  /// Radiance of flames alone, where nodes are channels.
  std::vector<Real> integrate(const RayBlock<Real>& block) const {
    const Medium& medium = *block.scene->medium;
    const auto stride = static_cast<std::size_t>(block.rays.size);
    std::vector<Real> radiance(stride * static_cast<std::size_t>(medium.channel_count()));
    std::vector<Real> transmittance(stride);
    MediumCounters counters;
    medium.integrate(block.rays, options_,
                     {radiance.data(), block.rays.size, transmittance.data(), 0}, counters);
    return radiance;
  }

  void add_rays(const RayBlock<Real>& block, const Real* radiance) {
    for (std::size_t c = 0; c < block.scene->scene.channels.size(); ++c)
      for (std::size_t i = 0; i < static_cast<std::size_t>(block.size); ++i) {
        const std::size_t pixel = static_cast<std::size_t>(
            (block.rows[i] - window_.y) * window_.width + block.columns[i] - window_.x);
        const Real carried = radiance[c * static_cast<std::size_t>(block.rays.size) + i];
        const std::size_t row =
            block.channel_of_scene(c) * replicates_ + static_cast<std::size_t>(block.replicates[i]);
        sums_.at(row)[pixel] +=
            static_cast<double>(block.etendue[i]) * static_cast<double>(carried);
      }
  }

  void add_replicates(std::size_t channel) {
    const auto n = static_cast<double>(replicates_);
    const std::size_t first = channel * replicates_;
    std::vector<double> flux(sums_[first].size()), error(flux.size());
    for (std::size_t i = 0; i < flux.size(); ++i) {
      for (std::size_t r = 0; r < replicates_; ++r) flux[i] += sums_[first + r][i];
      double squares = 0;
      for (std::size_t r = 0; r < replicates_; ++r)
        squares += std::pow(n * sums_[first + r][i] - flux[i], 2);
      error[i] = std::sqrt(squares / (n * (n - 1)));
    }
    flux_.push_back(std::move(flux));
    error_.push_back(std::move(error));
  }

  PixelWindow window_;
  MediumOptions options_;
  std::size_t replicates_;
  std::vector<std::vector<double>> sums_;          ///< of each channel, of each replicate
  std::vector<std::vector<double>> flux_, error_;  ///< of each channel
};

/// The streamed rays of a window make its picture, with radiance or without.
inline void expect_stream_makes_picture(const CompiledScene& scene, const PixelWindow& window,
                                        std::initializer_list<RayStreamContent> contents) {
  RenderSettings settings;
  settings.samples = 32;
  settings.window = window;
  const RenderResult picture = render(scene, settings);
  for (const RayStreamContent content : contents) {
    const StreamPicture<double> stream(scene, settings, {}, content);
    double sum = 0, apart = 0;
    for (std::size_t i = 0; i < stream.flux(0).size(); ++i) {
      const auto flux = static_cast<double>(picture.light_field.channels[0].flux.pixels[i]);
      sum += flux;
      apart += std::fabs(stream.flux(0)[i] - flux);
    }
    EXPECT_GT(sum, 0);
    EXPECT_LT(apart, 1e-5 * sum);
  }
}

}  // namespace plenoflame::test
