#include "plenoflame/measure/temperatures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "plenoflame/base/error.h"
#include "plenoflame/base/mended_by.h"
#include "plenoflame/camera/camera.h"
#include "plenoflame/lightfield/micro_images.h"
#include "plenoflame/measure/pupil_pyrometry.h"
#include "plenoflame/scene/spectral.h"

namespace plenoflame {
namespace {

constexpr double kSootWavelength = 650e-9, kSootFunction = 0.26;

AbsorptionSpectrum law_of(const TemperatureRequest& request, const Scene& scene,
                          std::string& name) {
  if (request.law == "grey" || (request.law.empty() && scene.flames.empty())) {
    name = "grey";
    return {};
  }
  if (request.law == "power") {
    name = fmt::format("(1/wavelength)^{:.4g}", request.exponent);
    return AbsorptionSpectrum::power(kSootWavelength, request.exponent);
  }
  if (request.law == "soot") {
    name = "soot, 1/wavelength";
    return AbsorptionSpectrum::soot(kSootWavelength, SootIndex::constant, kSootFunction);
  }
  if (!request.law.empty())
    throw UsageError("there is no law '" + request.law + "'; there are grey, soot and power");
  name = "as the scene's flames";
  for (const FlameSpec& flame : scene.flames)
    if (!(flame.spectrum == scene.flames.front().spectrum))
      throw mended_by(
          UsageError("the scene's flames have different spectra; choose grey, soot or power"),
          {"law"});
  const AbsorptionSpectrum law = absorption_spectrum(scene.flames.front().spectrum);
  if (law.is_grey()) name = "grey, as the scene's flames";
  return law;
}

std::size_t index_of(const LightField& field, const std::string& name) {
  const LightFieldChannel& channel = find_channel(field, name);
  return static_cast<std::size_t>(&channel - field.channels.data());
}

std::optional<PixelBins> bins_of(const TemperatureRequest& request, const LightField& field,
                                 const Scene& scene) {
  if (request.cells == 0)
    return request.block > 0 ? std::optional(block_bins(field.window, request.block))
                             : std::nullopt;
  if (!scene.camera.array.present)
    throw mended_by(UsageError("the camera has no microlens array; take blocks of pixels"),
                    {"bin"});
  check_raw_image(field, scene.camera, "the light field");
  return micro_image_bins(MicroImages(Camera(scene.camera), false), field.window, request.cells);
}

/// The relative error that the scales of two channels bring into their ratio; 0: nothing is known.
double scale_error_of_ratio(const LightField& field, std::size_t a, std::size_t b) {
  const auto error_of = [&](std::size_t channel) {
    const auto found = field.numbers.find("scale.error." + field.channels[channel].name);
    return found == field.numbers.end() ? 0.0 : found->second;
  };
  return std::hypot(error_of(a), error_of(b));
}

/// The two colours are those of filters over parts of the stop, in one channel.
Temperatures of_filters(const LightField& field, const Scene& scene,
                        const TemperatureRequest& request) {
  const auto refuse = [](const std::string& text, const char* setting) {
    throw mended_by(UsageError(text), {setting});
  };
  if (request.filters.size() != 2) refuse("filters are two names", "filters");
  if (request.channels.size() > 1) refuse("filters stand before one channel", "channels");
  if (request.block > 0 || request.cells > 0)
    refuse("filters add up the light of each microlens, and take no bins", "bin");
  const std::size_t channel =
      request.channels.empty() ? 0 : index_of(field, request.channels.front());
  Temperatures result;
  const AbsorptionSpectrum law = law_of(request, scene, result.law);
  PupilPyrometry found = pupil_pyrometry(
      field, scene, channel, {request.filters[0], request.filters[1]}, law, request.pixels);
  result.map = std::move(found.map);
  result.picture = std::move(found.picture);
  result.left_out = found.left_out;
  result.channels = {channel, channel};
  result.filter_pixels = {found.pixels[0], found.pixels[1]};
  return result;
}

}  // namespace

Temperatures find_temperatures(const LightField& field, const Scene& scene,
                               const TemperatureRequest& request) {
  if (!request.filters.empty()) {
    Temperatures result = of_filters(field, scene, request);
    result.picture.texts["pyrometry.law"] = result.law;
    return result;
  }
  if (!request.channels.empty() && request.channels.size() != 2)
    throw mended_by(UsageError("a ratio takes two channels"), {"channels"});
  if (field.channels.size() < 2 || scene.channels.size() < field.channels.size())
    throw InputError("two-colour pyrometry needs a light field with at least two channels");
  std::size_t a = 0, b = 1;
  if (!request.channels.empty()) {
    a = index_of(field, request.channels[0]);
    b = index_of(field, request.channels[1]);
  }
  const auto first = camera_response(scene, scene.channels[a]);
  const auto second = camera_response(scene, scene.channels[b]);
  if (!first || !second)
    throw mended_by(InputError("a channel of all wavelengths has no colour; choose two others"),
                    {"channels"});
  Temperatures result;
  const AbsorptionSpectrum law = law_of(request, scene, result.law);
  result.channels = {a, b};
  result.ratio.emplace(*first, *second, law);
  result.light = {light_in_proportion(field, scene, a), light_in_proportion(field, scene, b)};
  result.left_out =
      leave_out_bad_pixels(field, scene.camera.sensor.mosaic, a, b, result.light.data());
  result.bins = bins_of(request, field, scene);
  result.map = two_colour_map(result.light[0], result.light[1], *result.ratio, request.pixels,
                              result.bins ? &*result.bins : nullptr);
  if (const double scale = scale_error_of_ratio(field, a, b); scale > 0)
    result.scale_error = scale / std::fabs(result.ratio->slope(result.map.mean));
  LightField& picture = result.picture;
  picture = field;
  picture.channels = {{"temperature", result.map.temperature, result.map.standard_error}};
  std::erase_if(picture.layers,
                [](const auto& layer) { return !layer.first.starts_with("truth."); });
  picture.unit = "K";
  if (request.block > 0) picture.texts["pyrometry.bin"] = std::to_string(request.block);
  if (request.cells > 0)
    picture.texts["pyrometry.bin"] = request.cells == 1 ? "micro-image" : "view";
  picture.texts["pyrometry.law"] = result.law;
  picture.texts["pyrometry.channels"] = field.channels[a].name + "," + field.channels[b].name;
  return result;
}

}  // namespace plenoflame
