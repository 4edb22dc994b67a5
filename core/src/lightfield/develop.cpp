#include "plenoflame/lightfield/develop.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <vector>

#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

void check_finite(const Image& flux, const PixelWindow& window) {
  const auto bad = std::find_if(flux.pixels.begin(), flux.pixels.end(),
                                [](float value) { return !std::isfinite(value); });
  if (bad == flux.pixels.end()) return;
  const auto index = bad - flux.pixels.begin();
  throw InputError("the light field holds a value that is not finite, in column " +
                   std::to_string(window.x + index % flux.width) + ", row " +
                   std::to_string(window.y + index / flux.width));
}

}  // namespace

double encode_srgb(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

double automatic_saturation(const Image& flux) {
  std::vector<float> lit;
  std::copy_if(flux.pixels.begin(), flux.pixels.end(), std::back_inserter(lit),
               [](float value) { return value > 0; });
  if (lit.empty()) return 0;
  const auto above = static_cast<std::size_t>((1 - kAutomaticExposure) *
                                              static_cast<double>(lit.size()) * (1 + 1e-12));
  const auto place = lit.end() - 1 - static_cast<std::ptrdiff_t>(above);
  std::nth_element(lit.begin(), place, lit.end());
  return *place;
}

DevelopedImage develop(const LightField& light_field, const DevelopSpec& settings,
                       const std::string& channel) {
  if (settings.bits < 1 || settings.bits > 16)
    throw InputError("a sensor has 1 to 16 bits, not " + std::to_string(settings.bits));
  if (!(settings.saturation >= 0) || !std::isfinite(settings.saturation))
    throw InputError("the saturation flux must be above 0 W (or 0: automatic exposure)");
  const Image& flux = find_channel(light_field, channel).flux;
  if (flux.empty()) throw InputError("the light field was read without its pixels");
  check_finite(flux, light_field.window);

  DevelopedImage result;
  result.automatic = settings.saturation == 0;
  result.saturation = result.automatic ? automatic_saturation(flux) : settings.saturation;

  const int largest = (1 << settings.bits) - 1;
  // One entry per digital number: the curve is computed a few thousand times, not per pixel.
  std::vector<std::uint16_t> samples(static_cast<std::size_t>(largest) + 1);
  for (int number = 0; number <= largest; ++number) {
    const double linear = static_cast<double>(number) / largest;
    const double value = settings.curve == ToneCurve::display ? encode_srgb(linear) : linear;
    samples[static_cast<std::size_t>(number)] =
        static_cast<std::uint16_t>(std::lround(65535 * value));
  }

  PngImage& picture = result.picture;
  picture.width = flux.width;
  picture.height = flux.height;
  picture.bits = 16;
  picture.transfer = settings.curve == ToneCurve::display ? Transfer::srgb : Transfer::linear;
  // Through the display curve the digital number is no longer the upper bits of the sample.
  picture.significant_bits = settings.curve == ToneCurve::linear ? settings.bits : 0;
  picture.samples.reserve(flux.pixels.size());
  for (const float value : flux.pixels) {
    const double exact = value;
    if (exact > 0) ++result.lit;
    if (exact > 0 && exact >= result.saturation) ++result.saturated;
    const double relative = exact > 0 ? std::min(exact / result.saturation, 1.0) : 0.0;
    picture.samples.push_back(samples[static_cast<std::size_t>(std::lround(relative * largest))]);
  }
  result.saturated_share =
      static_cast<double>(result.saturated) / static_cast<double>(flux.pixels.size());
  return result;
}

}  // namespace plenoflame
