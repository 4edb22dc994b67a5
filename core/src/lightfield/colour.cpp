#include "plenoflame/lightfield/colour.h"

#include <algorithm>
#include <cmath>

#include "plenoflame/base/error.h"
#include "plenoflame/lightfield/develop.h"

namespace plenoflame {

std::array<double, 3> linear_srgb(const std::array<double, 3>& xyz) {
  const double x = xyz[0], y = xyz[1], z = xyz[2];
  return {3.2406 * x - 1.5372 * y - 0.4986 * z, -0.9689 * x + 1.8758 * y + 0.0415 * z,
          0.0557 * x - 0.2040 * y + 1.0570 * z};
}

PngImage colour_picture(const std::array<const Image*, 3>& images, const ColourSettings& settings) {
  const Image& first = *images[0];
  for (const Image* image : images) {
    if (image->width != first.width || image->height != first.height || image->empty())
      throw InputError("a colour picture needs three channels of the same size");
    for (const float value : image->pixels)
      if (!std::isfinite(value))
        throw InputError("the light field holds a value that is not finite");
  }
  double white = settings.saturation;
  if (!(white > 0)) {
    if (settings.is_xyz) white = automatic_saturation(*images[1]);
    for (std::size_t c = 0; c < 3 && !settings.is_xyz; ++c)
      white = std::max(white, automatic_saturation(*images[c]));
  }
  const double scale = white > 0 ? 1 / white : 0;
  PngImage picture;
  picture.width = first.width;
  picture.height = first.height;
  picture.channels = 3;
  picture.bits = 8;
  picture.transfer = Transfer::srgb;
  picture.samples.reserve(3 * first.pixels.size());
  for (std::size_t i = 0; i < first.pixels.size(); ++i) {
    std::array<double, 3> values{};
    for (std::size_t c = 0; c < 3; ++c)
      values[c] = scale * static_cast<double>(images[c]->pixels[i]);
    if (settings.is_xyz) values = linear_srgb(values);
    for (const double value : values)
      picture.samples.push_back(
          static_cast<std::uint16_t>(std::lround(255 * encode_srgb(std::clamp(value, 0.0, 1.0)))));
  }
  return picture;
}

ColourChannels colour_channels(const Scene& scene) {
  using Says = bool (*)(const ChannelSpec&, const char*);
  const Says by_standard = [](const ChannelSpec& channel, const char* response) {
    return channel.kind == ChannelKind::named && channel.response == response;
  };
  const Says by_camera = [](const ChannelSpec& channel, const char* ending) {
    return channel.kind == ChannelKind::named && channel.response.ends_with(ending);
  };
  const Says by_name = [](const ChannelSpec& channel, const char* name) {
    return channel.name == name;
  };
  struct Way {
    Says says;
    std::array<const char*, 3> words;
    bool is_xyz;
  };
  const Way ways[] = {{by_standard, {"cie_x", "cie_y", "cie_z"}, true},
                      {by_camera, {"_red", "_green", "_blue"}, false},
                      {by_name, {"red", "green", "blue"}, false},
                      {by_name, {"R", "G", "B"}, false}};
  for (const Way& way : ways) {
    ColourChannels colours;
    colours.is_xyz = way.is_xyz;
    std::size_t found = 0;
    for (std::size_t c = 0; c < 3; ++c)
      for (const ChannelSpec& channel : scene.channels)
        if (colours.names[c].empty() && way.says(channel, way.words[c])) {
          colours.names[c] = channel.name;
          ++found;
        }
    if (found == 3) return colours;
  }
  return {};
}

ColourChannels display_colours(const LightField& light_field, const Scene& scene) {
  if (light_field.unit == "e-")
    throw InputError(
        "the light field holds electrons; make the colour picture from the light field in W");
  ColourChannels colours;
  const char* const responses[] = {"cie_x", "cie_y", "cie_z"};
  for (std::size_t c = 0; c < scene.channels.size() && c < light_field.channels.size(); ++c)
    for (std::size_t k = 0; k < 3; ++k)
      if (scene.channels[c].kind == ChannelKind::named &&
          scene.channels[c].response == responses[k])
        colours.names[k] = light_field.channels[c].name;
  colours.is_xyz = std::ranges::none_of(colours.names, &std::string::empty);
  if (colours.is_xyz) return colours;
  if (light_field.channels.size() < 3)
    throw InputError(
        "a colour picture needs channels with the responses cie_x, cie_y and cie_z, or three "
        "channels as red, green and blue; the light field has " +
        std::to_string(light_field.channels.size()));
  for (std::size_t k = 0; k < 3; ++k) colours.names[k] = light_field.channels[k].name;
  return colours;
}

LightField colour_field(const LightField& light_field, const ColourChannels& colours) {
  std::array<const Image*, 3> images{};
  for (std::size_t c = 0; c < 3; ++c) images[c] = &find_channel(light_field, colours.names[c]).flux;
  LightField field = light_field;
  field.channels = {{"red", *images[0], {}}, {"green", *images[1], {}}, {"blue", *images[2], {}}};
  if (!colours.is_xyz) return field;
  for (std::size_t i = 0; i < images[0]->pixels.size(); ++i) {
    const std::array<double, 3> rgb = linear_srgb({static_cast<double>(images[0]->pixels[i]),
                                                   static_cast<double>(images[1]->pixels[i]),
                                                   static_cast<double>(images[2]->pixels[i])});
    for (std::size_t c = 0; c < 3; ++c)
      field.channels[c].flux.pixels[i] = static_cast<float>(rgb[c]);
  }
  return field;
}

}  // namespace plenoflame
