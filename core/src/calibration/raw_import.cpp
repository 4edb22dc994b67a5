#include "plenoflame/calibration/raw_import.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calibration/even_factors.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/version.h"
#include "plenoflame/lightfield/sensor.h"

namespace plenoflame {
namespace {

void check_same_size(const CountFrames* other, const CountFrames& raw, const char* what) {
  if (other == nullptr) return;
  if (other->width != raw.width || other->height != raw.height ||
      other->mean.size() != raw.mean.size())
    throw InputError(std::string("the ") + what + " has " + std::to_string(other->width) + " x " +
                     std::to_string(other->height) + " pixels and " +
                     std::to_string(other->mean.size()) + " channels, the picture " +
                     std::to_string(raw.width) + " x " + std::to_string(raw.height) + " and " +
                     std::to_string(raw.mean.size()) + ": they are of different sensors");
}

/// Variance of the mean of frames [counts^2] at some counts above dark.
double variance_of_mean(const CountFrames& frames, std::size_t channel, std::size_t pixel,
                        double above_dark, const ImportSettings& settings) {
  if (settings.noise == NoiseSource::pixel && frames.frames > 1)
    return static_cast<double>(frames.variance[channel].pixels[pixel]) / frames.frames;
  if (settings.noise == NoiseSource::series)
    return std::max(settings.transfer.floor + settings.transfer.slope * std::max(0.0, above_dark),
                    kRoundingVariance) /
           frames.frames;
  return sensor_variance(frames, above_dark, settings.response);
}

/// Counts above dark with their variance; after scale(), in the unit, with their standard error.
struct Signal {
  Image value, variance, error;
};

class Importer {
 public:
  Importer(const CountFrames& raw, const RawCorrections& corrections,
           const ImportSettings& settings, ImportSummary& summary)
      : raw_(raw), corrections_(corrections), settings_(settings), summary_(summary) {}

  LightField run() {
    check();
    state_ = raw_.state;
    for (std::size_t i = 0; i < corrections_.defects.size(); ++i)
      if (corrections_.defects[i] != 0)
        state_[i] = static_cast<std::uint8_t>(PixelState::defective);
    LightField field;
    field.window = settings_.window;
    field.estimator = "measured";
    field.version = version();
    field.unit = settings_.unit == ImportUnit::watts       ? "W"
                 : settings_.unit == ImportUnit::electrons ? "e-"
                                                           : "DN";
    std::vector<Signal> signals;
    for (std::size_t c = 0; c < raw_.mean.size(); ++c) signals.push_back(signal_of(c));
    for (std::size_t c = 0; c < signals.size(); ++c) {
      scale(signals[c], c);
      fill_defects(signals[c]);
    }
    if (mosaic()) {
      std::vector<DemosaicedColour> values =
          demosaic(signals[0].value, settings_.mosaic, settings_.window);
      std::vector<DemosaicedColour> errors =
          demosaic(signals[0].error, settings_.mosaic, settings_.window);
      for (std::size_t c = 0; c < 3; ++c)
        add_channel(field, settings_.names[c], std::move(values[c].values),
                    std::move(errors[c].values), &errors[c].counts);
      field.layers["sensor.raw"] = signals[0].value;
    } else {
      for (std::size_t c = 0; c < signals.size(); ++c)
        add_channel(field, settings_.names[c], std::move(signals[c].value),
                    std::move(signals[c].error), nullptr);
    }
    Image state(raw_.width, raw_.height);
    for (std::size_t i = 0; i < state_.size(); ++i) {
      state.pixels[i] = static_cast<float>(state_[i]);
      summary_.saturated += state_[i] == static_cast<std::uint8_t>(PixelState::saturated);
      summary_.defective += state_[i] == static_cast<std::uint8_t>(PixelState::defective);
    }
    check_defects();
    field.layers["sensor.state"] = std::move(state);
    return field;
  }

 private:
  bool mosaic() const { return settings_.mosaic != MosaicPattern::none; }
  int colour(std::size_t pixel) const {
    const auto width = static_cast<std::size_t>(raw_.width);
    return mosaic_colour(settings_.mosaic, settings_.window.x + static_cast<int>(pixel % width),
                         settings_.window.y + static_cast<int>(pixel / width));
  }

  /// The channel that a pixel of a picture's channel belongs to: of a mosaic its colour.
  std::size_t channel_of(std::size_t picture_channel, std::size_t pixel) const {
    return mosaic() ? static_cast<std::size_t>(colour(pixel)) : picture_channel;
  }

  void straighten(std::size_t picture_channel, std::size_t pixel, double& counts,
                  double& variance) const {
    if (!settings_.curvatures.empty())
      make_linear(settings_.curvatures[channel_of(picture_channel, pixel)], counts, variance);
  }

  void check() const {
    check_same_size(corrections_.dark, raw_, "dark frame");
    check_same_size(corrections_.flat, raw_, "flat field");
    check_same_size(corrections_.flat_dark, raw_, "dark frame of the flat field");
    check_same_size(corrections_.white, raw_, "white picture");
    check_same_size(corrections_.white_dark, raw_, "dark frame of the white picture");
    if (!corrections_.defects.empty() && corrections_.defects.size() != raw_.pixel_count())
      throw InputError("the defect map is not of the picture's size");
    if (settings_.window.width != raw_.width || settings_.window.height != raw_.height)
      throw InputError("the picture does not have the size of its window");
    if (mosaic() && raw_.mean.size() != 1)
      throw InputError("a mosaic is a picture of one channel, each pixel with its colour's counts");
    if (settings_.names.size() != (mosaic() ? 3 : raw_.mean.size()))
      throw InputError("a name is needed for each channel of the picture");
    if (settings_.unit == ImportUnit::electrons && !(settings_.response.gain > 0))
      throw InputError("electrons need the gain in electrons per count");
    if (settings_.unit == ImportUnit::watts &&
        settings_.watts_per_count.size() != settings_.names.size())
      throw InputError("watts need the flux that a count stands for");
    if (!settings_.curvatures.empty() && settings_.curvatures.size() != settings_.names.size())
      throw InputError("a curvature is needed for each channel of the picture");
  }

  void check_defects() const {
    constexpr double kMost = 0.05;
    const double share =
        static_cast<double>(summary_.defective) / static_cast<double>(raw_.pixel_count());
    if (share > kMost)
      throw InputError(fmt::format(
          "{:.0f} % of the pixels are defective, by the map of defects or by what the dark frames, "
          "the white picture and the flat field show; no sensor has more than 5 %: look at what "
          "these pictures are",
          100 * share));
  }

  /// Counts of dark at a pixel, and their variance.
  std::pair<double, double> dark_at(const CountFrames* dark, std::size_t channel,
                                    std::size_t pixel) const {
    const SensorResponse& sensor = settings_.response;
    if (dark == nullptr) return {sensor.black_level, 0.0};
    const double counts = static_cast<double>(dark->mean[channel].pixels[pixel]);
    return {counts,
            variance_of_mean(*dark, channel, pixel, counts - sensor.black_level, settings_)};
  }

  Signal signal_of(std::size_t channel) {
    Signal signal{Image(raw_.width, raw_.height), Image(raw_.width, raw_.height), Image()};
    const SensorResponse& sensor = settings_.response;
    // For electrons a number states the dark signal, as in develop; from watts it is subtracted.
    const double dark_signal =
        corrections_.dark == nullptr && settings_.unit != ImportUnit::electrons && sensor.gain > 0
            ? sensor.dark_current * sensor.exposure_time / sensor.gain
            : 0;
    double level = 0;
    for (std::size_t i = 0; i < raw_.pixel_count(); ++i) {
      const double counts = static_cast<double>(raw_.mean[channel].pixels[i]);
      const auto [dark, dark_variance] = dark_at(corrections_.dark, channel, i);
      level += dark + dark_signal;
      // Shot noise is of all electrons, those of the dark signal too.
      const double electrons_above =
          counts - (settings_.noise == NoiseSource::series ? dark : sensor.black_level);
      double variance =
          variance_of_mean(raw_, channel, i, electrons_above, settings_) + dark_variance;
      double value = counts - dark - dark_signal;
      straighten(channel, i, value, variance);
      signal.value.pixels[i] = static_cast<float>(value);
      signal.variance.pixels[i] = static_cast<float>(variance);
    }
    summary_.dark_level = level / static_cast<double>(raw_.pixel_count());
    if (corrections_.flat != nullptr)
      divide(signal, channel, *corrections_.flat,
             corrections_.flat_dark != nullptr ? corrections_.flat_dark : corrections_.dark,
             nullptr);
    if (corrections_.white != nullptr)
      divide(signal, channel, *corrections_.white,
             corrections_.white_dark != nullptr ? corrections_.white_dark : corrections_.dark,
             &settings_.model_white);
    return signal;
  }

  /// Multiplies by expected / measured light. Without `expected` all pixels are expected alike.
  void divide(Signal& signal, std::size_t channel, const CountFrames& measured,
              const CountFrames* dark, const Image* expected) {
    const EvenFactors even = even_factors(
        measured, expected, mosaic() ? 3 : 1,
        [&](std::size_t i) { return static_cast<std::size_t>(colour(i)); },
        [&](std::size_t i) {
          const auto [level, level_variance] = dark_at(dark, channel, i);
          const double counts = static_cast<double>(measured.mean[channel].pixels[i]);
          double light = counts - level;
          double variance = variance_of_mean(measured, channel, i,
                                             counts - settings_.response.black_level, settings_) +
                            level_variance;
          straighten(channel, i, light, variance);
          return std::pair{light, variance};
        });
    double squares = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < even.factors.size(); ++i) {
      const double factor = static_cast<double>(even.factors[i]);
      if (factor == 0) continue;
      if (factor < 0) {
        if (state_[i] == 0) {
          state_[i] = static_cast<std::uint8_t>(PixelState::defective);
          ++summary_.too_dark;
        }
        continue;
      }
      const double value = static_cast<double>(signal.value.pixels[i]);
      signal.value.pixels[i] = static_cast<float>(factor * value);
      signal.variance.pixels[i] =
          static_cast<float>(factor * factor *
                             (static_cast<double>(signal.variance.pixels[i]) +
                              value * value * static_cast<double>(even.relative_variance[i])));
      squares += (factor - 1) * (factor - 1);
      ++count;
    }
    if (expected != nullptr && count > 0)
      summary_.white_correction = std::sqrt(squares / static_cast<double>(count));
  }

  /// From counts to the unit.
  void scale(Signal& signal, std::size_t channel) const {
    signal.error = Image(raw_.width, raw_.height);
    for (std::size_t i = 0; i < raw_.pixel_count(); ++i) {
      const double factor = settings_.unit == ImportUnit::counts ? 1
                            : settings_.unit == ImportUnit::electrons
                                ? settings_.response.gain
                                : settings_.watts_per_count[channel_of(channel, i)];
      signal.value.pixels[i] =
          static_cast<float>(factor * static_cast<double>(signal.value.pixels[i]));
      signal.error.pixels[i] =
          static_cast<float>(factor * std::sqrt(static_cast<double>(signal.variance.pixels[i])));
    }
  }

  /// Defective pixels get the mean of their good neighbours of the same colour.
  void fill_defects(Signal& signal) const {
    const int step = mosaic() ? 2 : 1;
    for (int y = 0; y < raw_.height; ++y)
      for (int x = 0; x < raw_.width; ++x) {
        const std::size_t at = index(x, y);
        if (state_[at] != static_cast<std::uint8_t>(PixelState::defective)) continue;
        double sum = 0;
        int count = 0;
        for (int dy = -step; dy <= step; dy += step)
          for (int dx = -step; dx <= step; dx += step) {
            const int column = x + dx, row = y + dy;
            if (column < 0 || row < 0 || column >= raw_.width || row >= raw_.height) continue;
            if (state_[index(column, row)] == static_cast<std::uint8_t>(PixelState::defective))
              continue;
            sum += static_cast<double>(signal.value.pixels[index(column, row)]);
            ++count;
          }
        signal.value.pixels[at] = static_cast<float>(count > 0 ? sum / count : 0);
      }
  }

  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(raw_.width) +
           static_cast<std::size_t>(x);
  }

  /// @param counts of how many recorded pixels each value is the mean; nullptr: of one
  void add_channel(LightField& field, const std::string& name, Image value, Image error,
                   const Image* counts) {
    for (std::size_t i = 0; i < error.pixels.size(); ++i) {
      if (counts != nullptr) error.pixels[i] /= std::sqrt(std::max(1.0F, counts->pixels[i]));
      if (state_[i] != 0) continue;
      summary_.largest = std::max(summary_.largest, static_cast<double>(value.pixels[i]));
      summary_.negative +=
          static_cast<double>(value.pixels[i]) < -5 * static_cast<double>(error.pixels[i]);
    }
    field.channels.push_back({name, std::move(value), std::move(error)});
  }

  const CountFrames& raw_;
  const RawCorrections& corrections_;
  const ImportSettings& settings_;
  ImportSummary& summary_;
  std::vector<std::uint8_t> state_;
};

}  // namespace

LightField import_counts(const CountFrames& raw, const RawCorrections& corrections,
                         const ImportSettings& settings, ImportSummary& summary) {
  summary = {};
  return Importer(raw, corrections, settings, summary).run();
}

std::vector<std::uint8_t> hot_pixels(const CountFrames& dark, double limit) {
  const Image& mean = dark.mean.at(0);
  std::vector<float> sorted(mean.pixels.begin(), mean.pixels.end());
  std::sort(sorted.begin(), sorted.end());
  const auto quantile = [&](double share) {
    return static_cast<double>(
        sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))]);
  };
  const double middle = quantile(0.5);
  const double scatter = std::max(0.5 * (quantile(0.84) - quantile(0.16)), 0.5);
  std::vector<std::uint8_t> hot(mean.pixels.size(), 0);
  for (std::size_t i = 0; i < hot.size(); ++i)
    hot[i] = static_cast<double>(mean.pixels[i]) > middle + limit * scatter ? 1 : 0;
  return hot;
}

}  // namespace plenoflame
