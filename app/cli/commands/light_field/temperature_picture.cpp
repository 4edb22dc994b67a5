#include "commands/light_field/temperature_picture.h"

#include <cairo.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "options.h"
#include "plenoflame/image/png_file.h"

namespace plenoflame::cli {
namespace {

constexpr int kGap = 4, kBar = 12, kLabels = 52, kLeastHeight = 96;
constexpr double kFontSize = 11, kLabelDistance = 24;  ///< pixels

/// Like a black body: dark red, red, yellow, white. @param x from 0 to 1
std::array<std::uint16_t, 3> colour_of(double x) {
  const std::array<double, 3> rgb{0.25 + 2.2 * x, 2.6 * x - 0.75, 3.5 * x - 2.5};
  std::array<std::uint16_t, 3> samples{};
  for (std::size_t c = 0; c < 3; ++c)
    samples[c] = static_cast<std::uint16_t>(std::lround(255 * std::clamp(rgb[c], 0.0, 1.0)));
  return samples;
}

/// Round temperatures from low to high, far enough apart for their numbers: multiples of 1, 2 or 5
/// times a power of ten. If less than two fit, the ends of the range.
std::vector<double> round_temperatures(double low, double high, int height) {
  const double least = (high - low) * kLabelDistance / height;
  const double power = std::pow(10, std::floor(std::log10(least)));
  double step = 10 * power;
  for (const double factor : {5.0, 2.0, 1.0})
    if (factor * power >= least) step = factor * power;
  std::vector<double> values;
  for (double k = std::ceil(low / step); k * step <= high; k += 1) values.push_back(k * step);
  if (values.size() < 2) values = {low, high};
  return values;
}

/// Numbers and ticks beside the bar, as grey levels row by row.
std::vector<std::uint8_t> labels(double low, double high, int height) {
  const std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> surface(
      cairo_image_surface_create(CAIRO_FORMAT_A8, kLabels, height), cairo_surface_destroy);
  const std::unique_ptr<cairo_t, void (*)(cairo_t*)> context(cairo_create(surface.get()),
                                                             cairo_destroy);
  cairo_t* const c = context.get();
  cairo_select_font_face(c, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(c, kFontSize);
  for (const double value : round_temperatures(low, high, height)) {
    const double y = height * (high - value) / (high - low);
    cairo_rectangle(c, 0, std::clamp(std::floor(y), 0.0, height - 1.0), 3, 1);
    cairo_fill(c);
    const std::string text = readable_number(std::round(value)) + " K";
    cairo_move_to(c, 6, std::clamp(y + 4, kFontSize, height - 2.0));
    cairo_show_text(c, text.c_str());
  }
  cairo_surface_flush(surface.get());
  const unsigned char* const data = cairo_image_surface_get_data(surface.get());
  const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(surface.get()));
  std::vector<std::uint8_t> grey;
  for (int row = 0; row < height; ++row)
    for (std::size_t column = 0; column < kLabels; ++column)
      grey.push_back(data ? data[static_cast<std::size_t>(row) * stride + column] : 0);
  return grey;
}

}  // namespace

void write_temperature_picture(const std::string& path, const Image& temperature, double low,
                               double high) {
  PngImage picture;
  picture.height = std::max(temperature.height, kLeastHeight);
  const int bar = temperature.width + kGap, text = bar + kBar;
  picture.width = text + kLabels;
  picture.channels = 3;
  const std::vector<std::uint8_t> grey = labels(low, high, picture.height);
  for (int row = 0; row < picture.height; ++row)
    for (int column = 0; column < picture.width; ++column) {
      double t = 0;
      if (column < temperature.width && row < temperature.height)
        t = static_cast<double>(temperature.at(column, row));
      else if (column >= bar && column < text)
        t = high - (high - low) * (row + 0.5) / picture.height;
      std::array<std::uint16_t, 3> samples{};
      if (column >= text)
        samples.fill(grey[static_cast<std::size_t>(row) * kLabels +
                          static_cast<std::size_t>(column - text)]);
      else if (t > 0)
        samples = colour_of(std::clamp((t - low) / (high - low), 0.0, 1.0));
      picture.samples.insert(picture.samples.end(), samples.begin(), samples.end());
    }
  picture.texts = {{"Comment", "temperature from " + readable(low, Dimension::temperature) +
                                   " (dark red) to " + readable(high, Dimension::temperature) +
                                   " (white)"}};
  write_png(path, picture);
}

}  // namespace plenoflame::cli
