// Channels, spectra of the flames, and the sensor's response.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plenoflame/base/units.h"
#include "plenoflame/camera/sensor_levels.h"
#include "plenoflame/optics/glass.h"
#include "plenoflame/scene/spectral.h"
#include "scene/schema/nearest.h"
#include "scene/validation/channel_kind_checks.h"
#include "scene/validation/issues.h"

namespace plenoflame {
namespace {

bool is_channel_name(const std::string& name) {
  const auto good = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-';
  };
  return !name.empty() && std::all_of(name.begin(), name.end(), good);
}

/// A quantum efficiency is a share: what is above 1 is most likely in percent.
void check_photons(const ChannelSpec& channel, const std::string& path, Issues& issues) {
  if (!channel.photons || channel.kind != ChannelKind::curve || channel.curve.empty()) return;
  double largest = 0;
  issues.expect(path + ".curve", "channel " + quote_for_message(channel.name), [&] {
    for (const SpectralPoint& point : parse_spectral_points(channel.curve))
      largest = std::max(largest, point.value);
  });
  if (!(largest > 1)) return;
  const std::string name = quote_for_message(channel.name);
  const std::string key = path + (channel.file.empty() ? ".curve" : ".file");
  if (largest <= 100)
    issues.error(key, fmt::format("channel {} has photons = true, so that its curve is a quantum "
                                  "efficiency, 0 to 1, but it reaches {:g}; that looks like "
                                  "percent: divide its values by 100",
                                  name, largest));
  else
    issues.error(key, fmt::format("channel {} has photons = true, so that its curve is a quantum "
                                  "efficiency, 0 to 1, but it reaches {:g}; scale its values",
                                  name, largest));
}

void check_spectrum(const FlameSpec& flame, const std::string& path, Issues& issues) {
  const SpectrumSpec& spectrum = flame.spectrum;
  if (spectrum.kind == SpectrumKind::table && spectrum.table.empty())
    issues.error(path + ".spectrum.table",
                 path + ".spectrum is a table and needs points, like \"450 nm 1.4, 650 nm 1\"");
  else
    issues.expect(path + ".spectrum.kind", path + ".spectrum",
                  [&] { static_cast<void>(absorption_spectrum(spectrum)); });
  for (std::size_t i = 0; i < flame.layers.size(); ++i) {
    const EllipsoidSpec& layer = flame.layers[i];
    const std::string key = fmt::format("{}.layers[{}].volume_fraction", path, i);
    if (layer.volume_fraction == 0) continue;
    if (spectrum.kind != SpectrumKind::soot)
      issues.error(key, fmt::format("{} is a volume fraction of soot, which needs the flame's "
                                    "spectrum.kind = \"soot\"",
                                    key));
    if (layer.absorption != 0)
      issues.error(key, fmt::format("{} and the absorption of the same layer are both given; keep "
                                    "one of them",
                                    key));
  }
}

/// Share of a response that lies between two wavelengths: the dim ends of a sensor's do not count.
double share_within(const SpectralResponse& response, double shortest, double longest) {
  if (response.shortest() >= shortest && response.longest() <= longest) return 1;
  if (response.longest() <= shortest || response.shortest() >= longest) return 0;
  const auto band = SpectralResponse::band(0.5 * (shortest + longest), longest - shortest);
  try {
    return response.behind(band).integral() / response.integral();
  } catch (const InputError&) {
    return 0;  // it is 0 there
  }
}

/// Channels outside of the range for which the makers of the catalogue's glasses give indices.
void check_glass_range(const Scene& scene, Issues& issues) {
  std::vector<const CatalogueGlass*> glasses;
  const auto look_at = [&](const std::string& text) {
    const CatalogueGlass* glass = text.empty() ? nullptr : find_catalogue_glass(text);
    if (glass && std::find(glasses.begin(), glasses.end(), glass) == glasses.end())
      glasses.push_back(glass);
  };
  for (const SurfaceSpec& surface : scene.camera.lens.surfaces) look_at(surface.glass);
  if (scene.camera.array.present)
    for (const MicrolensSpec& type : scene.camera.array.types) look_at(type.glass);
  for (const WindowSpec& window : scene.windows) look_at(window.glass);
  for (std::size_t i = 0; i < scene.channels.size() && !glasses.empty(); ++i) {
    const ChannelSpec& channel = scene.channels[i];
    if (channel.kind == ChannelKind::total ||
        (channel.kind == ChannelKind::curve && channel.curve.empty()))
      continue;
    const auto response = spectral_response(channel);
    if (!response) continue;
    for (const CatalogueGlass* glass : glasses) {
      const double shortest = 1e-6 * glass->range[0], longest = 1e-6 * glass->range[1];
      if (share_within(*response, shortest, longest) > 0.99) continue;
      issues.error(
          fmt::format("channels[{}].kind", i),
          fmt::format("channel {} reaches from {} to {}, but the index of glass {} is known from "
                      "{} to {} only; choose another band, or give an index",
                      quote_for_message(channel.name), short_length(response->shortest()),
                      short_length(response->longest()),
                      quote_for_message(std::string(glass->name)), short_length(shortest),
                      short_length(longest)));
    }
  }
}

/// Channels beyond what a glass's formula or the filter knows.
void check_camera_spectra(const Scene& scene, Issues& issues) {
  const std::string& filter = scene.camera.transmission.filter;
  if (!filter.empty())
    issues.expect("camera.transmission.filter", "camera.transmission.filter", [&] {
      for (const SpectralPoint& point : parse_spectral_points(filter))
        if (point.value > 1) throw InputError("a filter lets at most everything through, 1");
    });
  // Light must be left of each channel, once both are sound.
  for (const ChannelSpec& channel : scene.channels)
    if (!filter.empty() && issues.errors() == 0 &&
        !(channel.kind == ChannelKind::curve && channel.curve.empty()))
      issues.expect("camera.transmission.filter", "channel " + quote_for_message(channel.name),
                    [&] { static_cast<void>(camera_response(scene, channel)); });
  check_pupil_filters(scene, issues);
  const double coating = scene.camera.transmission.coating_index;
  if (coating > 0 && coating < 1)
    issues.error("camera.transmission.coating_index",
                 fmt::format("camera.transmission.coating_index is {:g}; an index is 1 or more, or "
                             "0 for no coating",
                             coating));
  if (coating > 0 && !scene.camera.transmission.fresnel)
    issues.warning("camera.transmission.coating_index",
                   "a coating has no effect without camera.transmission.fresnel = true");
  if (issues.errors() > 0) return;
  check_glass_range(scene, issues);
  for (std::size_t i = 0; i < scene.channels.size(); ++i)
    issues.expect(fmt::format("channels[{}].kind", i),
                  "channel " + quote_for_message(scene.channels[i].name), [&] {
                    const ChannelSpec& channel = scene.channels[i];
                    if (channel.kind == ChannelKind::total ||
                        (channel.kind == ChannelKind::curve && channel.curve.empty()))
                      return;
                    Scene alone = scene;
                    alone.channels = {channel};
                    alone.channels[0].wavelengths = 16;  // to both ends of the response
                    static_cast<void>(is_dispersive(alone));
                  });
}

void check_scattering(const FlameSpec& flame, const std::string& path, Issues& issues) {
  if (!flame.scattering.present()) return;
  const std::string grid = path + ".scattering.grid";
  if (!flame.scattering.grid.empty() && flame.kind == FlameKind::layered)
    issues.error(grid,
                 grid + " is a grid of a file, but the flame is layered; give albedo a number");
  if (!flame.scattering.grid.empty() && flame.scattering.albedo > 0)
    issues.error(grid, grid + " and albedo are both given; keep one of them");
  if (flame.scattering.albedo >= 1)
    issues.error(
        path + ".scattering.albedo",
        path + ".scattering.albedo is 1, which makes scattering infinite; it must be below 1");
}

void check_sensor(const Scene& scene, Issues& issues) {
  const SensorSpec& sensor = scene.camera.sensor;
  if (sensor.black_level >= std::ldexp(1.0, sensor.bits) - 1)
    issues.error("camera.sensor.black_level",
                 fmt::format("camera.sensor.black_level is {:g}, but the largest number of {} bits "
                             "is {}; lower it",
                             sensor.black_level, sensor.bits, (1 << sensor.bits) - 1));
  else if (dark_pixel_excess(sensor) > 0.01 * sensor.read_noise)
    issues.warning(
        "camera.sensor.black_level",
        fmt::format(
            "camera.sensor.black_level leaves {:.3g} electrons below it, too few for a read "
            "noise of {:g}: numbers are cut off at 0, and dark pixels have {:.2g} electrons "
            "too many on average; {}",
            resolved_levels(sensor).black_level * resolved_levels(sensor).gain, sensor.read_noise,
            dark_pixel_excess(sensor),
            sensor.black_level > 0 ? "raise it, or give 0 for automatic" : "use more bits"));
  if (sensor.hot_pixels + sensor.dead_pixels > 1)
    issues.error("camera.sensor.dead_pixels",
                 "the sum of camera.sensor.hot_pixels and dead_pixels is above 1; reduce them");
  if (sensor.mosaic != MosaicPattern::none && scene.channels.size() < 3)
    issues.error("camera.sensor.mosaic",
                 fmt::format("camera.sensor.mosaic needs three channels, red, green and blue; the "
                             "scene has {}",
                             scene.channels.size()));
}

}  // namespace

void check_channels(const Scene& scene, Issues& issues) {
  constexpr std::size_t kLongestName = 100;  // files of images allow 255, suffixes included
  for (std::size_t i = 0; i < scene.channels.size(); ++i) {
    const ChannelSpec& channel = scene.channels[i];
    const std::string path = fmt::format("channels[{}]", i);
    if (!is_channel_name(channel.name))
      issues.error(path + ".name",
                   fmt::format("the channel name {} is not made of letters, digits, _ and -",
                               quote_for_message(channel.name)));
    if (channel.name.size() > kLongestName)
      issues.error(path + ".name",
                   fmt::format("the channel name {} has {} characters; at most {} are allowed",
                               quote_for_message(channel.name), channel.name.size(), kLongestName));
    for (std::size_t k = 0; k < i; ++k)
      if (scene.channels[k].name == channel.name)
        issues.error(path + ".name",
                     fmt::format("channels {} and {} are both named {}; names must differ", k, i,
                                 quote_for_message(channel.name)));
    check_channel_kind(channel, path, issues);
    check_photons(channel, path, issues);
  }
  for (std::size_t i = 0; i < scene.flames.size(); ++i)
    check_spectrum(scene.flames[i], fmt::format("flames[{}]", i), issues);
  for (std::size_t i = 0; i < scene.flames.size(); ++i)
    check_scattering(scene.flames[i], fmt::format("flames[{}]", i), issues);
  check_sensor(scene, issues);
  check_camera_spectra(scene, issues);
}

}  // namespace plenoflame
