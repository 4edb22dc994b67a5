#include "raw_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>

#include "options.h"
#include "plenoflame/base/error.h"
#include "plenoflame/camera/sensor_levels.h"
#include "plenoflame/lightfield/sensor.h"

namespace plenoflame {

RawLayout RawFileOptions::layout() const {
  RawLayout layout;
  if (!size.empty()) {
    const std::array<int, 2> sides = pair_option(names("size"), size, "WxH", 'x');
    constexpr int kLongest = 100000;
    if (sides[0] < 1 || sides[1] < 1 || sides[0] > kLongest || sides[1] > kLongest)
      throw UsageError(names("size") + ": sides from 1 to 100000 pixels");
    layout.width = sides[0];
    layout.height = sides[1];
  }
  layout.bits = bits.value_or(16);
  layout.big_endian = endian == "big";
  layout.skip = skip.value_or(0);
  if (layout.skip > std::uint64_t{1} << 40)
    throw UsageError(names("skip") + ": at most 2^40 bytes");
  return layout;
}

template <>
std::span<const SettingRow<RawFileOptions>> setting_rows() {
  using R = RawFileOptions;
  using enum SettingKind;
  static const std::vector<SettingRow<R>> rows{
      {"size", "WxH", "Columns and rows of files that hold numbers without a header", &R::size,
       sides},
      {"bits", "N",
       "Bits of a number, e.g. 12 in 16 (those of the file); in headerless files up to 8 take one "
       "byte, more take two",
       &R::bits, between(1, 16)},
      {"endian", "ORDER", "Order of bytes in headerless files: little or big", &R::endian,
       any_of("little", "big")},
      {"skip", "N", "Bytes in front of headerless numbers (0)", &R::skip},
      {"shift", "N", "Bits by which numbers are too large, e.g. 4 for 12 bits at the top of 16",
       &R::shift, between(0, 15)},
      {"turn", "DEGREES", "Turns the pictures clockwise to be upright: 0, 90, 180 or 270 degrees",
       &R::turn, any_of("0", "90", "180", "270")},
      {"mirror", "", "Mirrors the pictures left to right, before they are turned", &R::mirror}};
  return rows;
}

std::vector<std::string> files_of(const std::vector<std::string>& names) {
  std::vector<std::string> files;
  for (const std::string& name : names) {
    std::error_code error;
    if (!std::filesystem::is_directory(name, error)) {
      files.push_back(name);
      continue;
    }
    std::vector<std::string> inside;
    for (auto entry = std::filesystem::directory_iterator(name, error);
         !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
      std::error_code ignored;
      if (entry->is_regular_file(ignored) && !entry->path().filename().string().starts_with('.'))
        inside.push_back(entry->path().string());
    }
    if (error) throw FileError("cannot read the folder '" + name + "': " + error.message());
    if (inside.empty()) throw InputError("the folder '" + name + "' holds no file");
    std::sort(inside.begin(), inside.end(), [](const std::string& a, const std::string& b) {
      return strverscmp(a.c_str(), b.c_str()) < 0;
    });
    files.insert(files.end(), inside.begin(), inside.end());
  }
  return files;
}

CountFrames read_frames(const std::vector<std::string>& names_of_files,
                        const RawFileOptions& options, const Execution& execution, double full) {
  const RawLayout layout = options.layout();
  const std::vector<std::string> files = files_of(names_of_files);
  if (files.empty()) throw UsageError("no picture is given");
  const SettingNames& names = options.names;
  FrameSums sums(full);
  std::string kind;
  for (const std::string& file : files) {
    bool told = false;
    read_raw_pictures(file, layout, [&](RawPicture&& picture) {
      if (picture.lossy && !told)
        execution.warn("'" + file +
                       "' was packed with losses (JPEG): what noise and dark pixels say "
                       "is gone, and where it "
                       "was made to be looked at, its numbers follow a display's curve "
                       "and are no counts; "
                       "save the camera's raw numbers as TIFF or PNG where you can");
      if (picture.display_curve && !told)
        execution.warn("'" + file +
                       "' has 8 bits: if they were made to be looked at, they "
                       "follow a display's curve and "
                       "are "
                       "no counts; they are taken for counts");
      told = true;
      if (options.shift > 0) {
        for (std::uint16_t& sample : picture.samples)
          sample = static_cast<std::uint16_t>(sample >> options.shift);
        picture.bits = std::max(1, picture.bits - options.shift);
      }
      if (options.bits) {
        const std::uint32_t largest = (1U << *options.bits) - 1;
        for (const std::uint16_t sample : picture.samples)
          if (sample > largest)
            throw InputError("'" + file + "' holds numbers above " + std::to_string(largest) +
                             ", the largest of " + std::to_string(*options.bits) + " bits: check " +
                             names("bits") + ", or give " + names("shift"));
        picture.bits = *options.bits;
      }
      kind = picture.kind;
      sums.add(turned(std::move(picture), std::stoi(options.turn) / 90, options.mirror),
               "'" + file + "'");
    });
  }
  CountFrames frames = sums.result();
  if (frames.common_shift > 0 && frames.bits > 8 && options.shift == 0)
    execution.warn("all numbers of '" + files.front() + "' are multiples of " +
                   std::to_string(1 << frames.common_shift) + ": if these are " +
                   std::to_string(frames.bits - frames.common_shift) + " bits moved up, give " +
                   names("shift", std::to_string(frames.common_shift)));
  return frames;
}

double full_of(const RawFileOptions& options, const SensorSpec& sensor) {
  return options.bits ? 0 : full_counts(resolved_levels(sensor));
}

void warn_of_full(const CountFrames& frames, const std::string& file, double full,
                  const SensorSpec& sensor, const Execution& execution) {
  if (full > 0) {
    const double largest = std::ldexp(1.0, sensor.bits) - 1;
    float most = 0;
    for (const Image& image : frames.mean)
      for (const float value : image.pixels) most = std::max(most, value);
    if (static_cast<double>(most) > largest) {
      execution.warn(
          fmt::format("'{}' holds numbers up to {:.0f}, and the camera's "
                      "sensor has {} bits, {:.0f} "
                      "at most: check camera.sensor.bits, or give the shift",
                      file, most, sensor.bits, largest));
      return;
    }
  }
  constexpr double kMany = 0.05;
  const double share =
      static_cast<double>(frames.saturated) / static_cast<double>(frames.pixel_count());
  if (share < kMany) return;
  const double least = full > 0 ? full : std::ldexp(1.0, frames.bits) - 1;
  execution.warn(
      fmt::format("{:.0f} % of the pixels of '{}' are full ({:.0f} counts{}): expose it "
                  "less",
                  100 * share, file, least,
                  full > 0 ? " or more, by full_well, gain and bits of the camera's file" : ""));
}

Image light_of(const CountFrames& frames, const std::optional<CountFrames>& dark,
               MosaicPattern mosaic) {
  if (dark && (dark->width != frames.width || dark->height != frames.height ||
               dark->mean.size() != frames.mean.size()))
    throw InputError(fmt::format("a dark frame of {} x {} pixels and a picture of {} x {}{}",
                                 dark->width, dark->height, frames.width, frames.height,
                                 dark->mean.size() == frames.mean.size()
                                     ? ": they have one size"
                                     : ", of another number of colours"));
  Image light(frames.width, frames.height);
  for (std::size_t c = 0; c < frames.mean.size(); ++c)
    for (std::size_t i = 0; i < light.pixels.size(); ++i)
      light.pixels[i] += frames.mean[c].pixels[i] - (dark ? dark->mean[c].pixels[i] : 0.0F);
  if (mosaic == MosaicPattern::none) return light;
  double sum[3] = {}, count[3] = {};
  for (int y = 0; y < light.height; ++y)
    for (int x = 0; x < light.width; ++x) {
      const int colour = mosaic_colour(mosaic, x, y);
      sum[colour] += static_cast<double>(light.at(x, y));
      count[colour] += 1;
    }
  for (int y = 0; y < light.height; ++y)
    for (int x = 0; x < light.width; ++x) {
      const int colour = mosaic_colour(mosaic, x, y);
      const double factor = sum[1] / count[1] * count[colour] / sum[colour];
      if (std::isfinite(factor))
        light.at(x, y) = static_cast<float>(factor * static_cast<double>(light.at(x, y)));
    }
  return light;
}

}  // namespace plenoflame
