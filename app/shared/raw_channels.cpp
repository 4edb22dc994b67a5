#include "raw_channels.h"

#include <fmt/format.h>

#include <filesystem>
#include <map>

#include "options.h"
#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

[[noreturn]] void refuse_channel(const std::string& where, const std::string& name,
                                 const Scene& scene) {
  std::string names;
  for (const ChannelSpec& channel : scene.channels)
    names += (names.empty() ? "" : ", ") + channel.name;
  throw UsageError(where + ": the camera's file has no channel '" + name + "'; it has " + names);
}

/// The channel in front of a value, NAME=VALUE; the number of channels: there is none. A file of
/// that name is a file. @throws UsageError for another name in front of a file
std::size_t channel_in_front(const std::string& text, const Scene& scene) {
  const std::size_t sign = text.find('=');
  if (sign == std::string::npos || std::filesystem::exists(text)) return scene.channels.size();
  const std::string name = text.substr(0, sign);
  for (std::size_t c = 0; c < scene.channels.size(); ++c)
    if (scene.channels[c].name == name) return c;
  if (std::filesystem::exists(text.substr(sign + 1))) refuse_channel(text, name, scene);
  return scene.channels.size();
}

}  // namespace

double exposure_of_text(const std::string& setting, const std::string& text) {
  constexpr double kMost = 1e6;  // [s]
  const double value = quantity_option(setting, text, Dimension::time);
  if (!(value > 0 && value <= kMost))
    throw UsageError(fmt::format("{}: above 0, at most {:g} s, not '{}'", setting, kMost, text));
  return value;
}

std::vector<std::string> values_of_channel(const std::string& option,
                                           const std::vector<std::string>& values,
                                           const std::string& channel, const Scene& scene) {
  std::vector<std::string> common, own;
  for (const std::string& value : values) {
    const std::size_t c = channel_in_front(value, scene);
    if (c == scene.channels.size()) {
      common.push_back(value);
      continue;
    }
    if (channel.empty())
      throw UsageError(option + ": a channel in front (NAME=...) is for pictures of one channel");
    if (scene.channels[c].name == channel) own.push_back(value.substr(value.find('=') + 1));
  }
  return own.empty() ? common : own;
}

std::vector<ChannelFiles> channel_files(const RawPicturesRequest& arguments, const Scene& scene) {
  std::map<std::size_t, ChannelFiles> named;
  ChannelFiles plain;
  for (const std::string& raw : arguments.raw) {
    const std::size_t channel = channel_in_front(raw, scene);
    if (channel == scene.channels.size()) {
      plain.files.push_back(raw);
    } else {
      named[channel].channels = {scene.channels[channel].name};
      named[channel].files.push_back(raw.substr(raw.find('=') + 1));
    }
  }
  std::vector<ChannelFiles> all;
  for (auto& [channel, files] : named) all.push_back(files);
  if (!plain.files.empty()) {
    if (!all.empty())
      throw UsageError("RAW: either all files have their channel in front (NAME=FILE) or none");
    if (!arguments.channel.empty()) plain.channels = {arguments.channel};
    all.push_back(plain);
  } else if (!arguments.channel.empty()) {
    throw UsageError(arguments.names()("channel") + ": the files have their channels in front");
  }
  return all;
}

std::size_t channel_number(const Scene& scene, const std::string& name,
                           const SettingNames& setting) {
  for (std::size_t c = 0; c < scene.channels.size(); ++c)
    if (scene.channels[c].name == name) return c;
  refuse_channel(setting("channel"), name, scene);
}

std::vector<std::string> names_of(const ChannelFiles& files, const CountFrames& frames,
                                  const Scene& scene, bool mosaic, const SettingNames& setting) {
  const std::size_t wanted = mosaic ? 3 : frames.mean.size();
  if (!files.channels.empty()) {
    if (wanted != 1)
      throw InputError((mosaic ? "a mosaic's picture has three channels"
                               : "'" + files.files.front() + "' is a picture in colour") +
                       "; leave " + setting("channel") + " out");
    channel_number(scene, files.channels.front(), setting);
    return files.channels;
  }
  std::vector<std::string> names;
  for (const ChannelSpec& channel : scene.channels) names.push_back(channel.name);
  if (wanted > names.size() || (wanted < names.size() && wanted == 1))
    throw InputError(fmt::format(
        "'{}' has {} channel{}, the camera's file {}{}", files.files.front(), wanted,
        wanted == 1 ? "" : "s", names.size(),
        wanted == 1 ? ": say which it is with " + setting("channel", "NAME") + " (or NAME=FILE)"
                    : ""));
  names.resize(wanted);
  return names;
}

template <>
std::span<const SettingRow<RawPicturesRequest>> setting_rows() {
  using R = RawPicturesRequest;
  using enum SettingKind;
  static const std::vector<SettingRow<R>> rows{
      {"channel", "NAME", "Channel of a grey picture, where the file has several", &R::channel},
      {"unit", "UNIT",
       "What pixels hold: e- (electrons), W, or DN, counts above dark (e-; with a radiometry W)",
       &R::unit, any_of("e-", "W", "DN")},
      {"dark", "FILE ...",
       "Dark frames of the same exposure; NAME=FILE: of that channel alone, as in the options "
       "below",
       &R::dark, file},
      {"flat", "FILE ...", "Flat field: the bare sensor, evenly lit", &R::flat, file},
      {"flat-dark", "FILE ...", "Its dark frames (those of the pictures)", &R::flat_dark, file},
      {"white", "FILE ...",
       "White picture through the whole camera: pixels become what the camera's model would have "
       "recorded",
       &R::white, file},
      {"white-dark", "FILE ...", "Its dark frames (those of the pictures)", &R::white_dark, file},
      {"defects", "FILE|auto",
       "Defective pixels: a picture in which they are not 0, lines column,row (.csv), or 'auto': "
       "those that shine in the dark frames",
       &R::defects, file},
      {"gain", "NUMBER", "Electrons per count (of the camera's file)", &R::gain, between(0, 1e9)},
      {"read-noise", "NUMBER", "Electrons (of the camera's file)", &R::read_noise, between(0, 1e6)},
      {"black-level", "COUNTS",
       "Counts without light, where there is no dark frame (of the camera's file)", &R::black_level,
       between(0, 65535)},
      {"exposure-time", "TIME",
       "Of a frame (of the camera's file); NAME=TIME: of that channel's; repeatable",
       &R::exposure_time},
      {"saturation", "COUNTS",
       "Counts from which on a pixel is full (full well, or the largest number)", &R::saturation,
       between(1, 65535)},
      {"noise", "SOURCE",
       "Errors from gain and read noise (sensor), from scatter against light in a series (series), "
       "or from each pixel's scatter (pixel)",
       &R::noise, any_of("sensor", "series", "pixel")},
      {"radiometry", "FILE.toml",
       "Energy of a count, from calibrate radiometry; repeatable for several channels",
       &R::radiometry, file},
      {"window", "X,Y,W,H", "Part of the sensor that the pictures hold (all)", &R::window}};
  return rows;
}

}  // namespace plenoflame
