#include "html_page.h"

#include <cairo.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string_view>

#include "colour_map.h"
#include "plenoflame/base/error.h"
#include "plenoflame/math/readable.h"
#include "plot.h"

namespace plenoflame::cli {
namespace {

constexpr double kPanelWidth = 300, kHighest = 450;  // points
constexpr double kBeside = 46, kBelow = 36;          // room for axes
constexpr double kLeastPanel = 190;  // room for a title and for the numbers of a scale
constexpr Rgb kNotKnown{153, 153, 153};

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '&')
      result += "&amp;";
    else if (c == '<')
      result += "&lt;";
    else if (c == '>')
      result += "&gt;";
    else if (c == '"')
      result += "&quot;";
    else
      result += c;
  }
  return result;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k > bytes.size() ? '=' : kDigits[group >> (18 - 6 * k) & 63U];
  }
  return text;
}

cairo_status_t append(void* text, const unsigned char* data, unsigned int length) {
  static_cast<std::string*>(text)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
}

struct SurfaceDeleter {
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
};

std::string png_of(const HeatMap& map) {
  const std::unique_ptr<cairo_surface_t, SurfaceDeleter> surface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, map.width, map.height));
  unsigned char* const bytes = cairo_image_surface_get_data(surface.get());
  if (!bytes) throw Error("a picture of the report cannot be made");
  const int stride = cairo_image_surface_get_stride(surface.get());
  const ColourMap colours = map.signed_values ? ColourMap::diverging : ColourMap::inferno;
  for (int row = 0; row < map.height; ++row)
    for (int column = 0; column < map.width; ++column) {
      const double value = map.values[static_cast<std::size_t>(row * map.width + column)];
      const double share = map.high > map.low ? (value - map.low) / (map.high - map.low) : 0;
      const Rgb rgb = std::isfinite(share) ? colour(colours, share) : kNotKnown;
      *reinterpret_cast<std::uint32_t*>(bytes + row * stride + 4 * column) =
          std::uint32_t{rgb.red} << 16 | std::uint32_t{rgb.green} << 8 | rgb.blue;
    }
  cairo_surface_mark_dirty(surface.get());
  std::string png;
  if (cairo_surface_write_to_png_stream(surface.get(), append, &png) != CAIRO_STATUS_SUCCESS)
    throw Error("a picture of the report cannot be made");
  return png;
}

/// The scale below a map.
std::string colour_bar(const HeatMap& map) {
  HeatMap bar;
  bar.width = 128;
  bar.height = 1;
  bar.signed_values = map.signed_values;
  for (int i = 0; i < bar.width; ++i) bar.values.push_back(i / 127.0);
  return fmt::format(
      "<img class=\"bar\" alt=\"\" src=\"data:image/png;base64,{}\">"
      "<div class=\"scale\"><span>{:.4g}</span><span>{}</span><span>{:.4g}</span></div>",
      base64(png_of(bar)), map.low, escaped(map.unit), map.high);
}

/// Marks, numbers and name of the axis below a map or, `upright`, beside it.
std::string axis_svg(const SliceAxis& axis, bool upright, double width, double height) {
  if (axis.label.empty()) return "";
  const double low = std::min(axis.first, axis.last), high = std::max(axis.first, axis.last);
  const double step =
      tick_step(high - low, upright ? 6 : std::max(1, static_cast<int>(width / 50)));
  std::string svg;
  for (double tick = std::ceil(low / step) * step; tick <= high; tick += step) {
    const double share = (tick - axis.first) / (axis.last - axis.first);
    const double x = kBeside + share * width, y = height - share * height;
    const double value = std::fabs(tick) < 1e-9 * step ? 0 : tick;
    svg += upright ? fmt::format(
                         "<path d=\"M{:.1f} {:.1f}h-4\"/><text x=\"{:.1f}\" y=\"{:.1f}\" "
                         "text-anchor=\"end\">{:.6g}</text>",
                         kBeside, y, kBeside - 6, y + 4, value)
                   : fmt::format(
                         "<path d=\"M{:.1f} {:.1f}v4\"/><text x=\"{:.1f}\" y=\"{:.1f}\" "
                         "text-anchor=\"middle\">{:.6g}</text>",
                         x, height, x, height + 16, value);
  }
  return svg +
         (upright ? fmt::format("<text text-anchor=\"middle\" transform=\"translate(10 {:.1f}) "
                                "rotate(-90)\">{}</text>",
                                height / 2, escaped(axis.label))
                  : fmt::format("<text text-anchor=\"middle\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>",
                                kBeside + width / 2, height + 32, escaped(axis.label)));
}

/// The map with its axes, and its scale. A tall one is narrow.
std::string figure_of(const HeatMap& map) {
  const bool bare = map.across.label.empty();
  const double beside = bare ? 0 : kBeside, ratio = map.aspect * map.height / map.width;
  const double height = std::clamp((kPanelWidth - beside) * ratio, 20.0, kHighest);
  const double width = std::min(kPanelWidth - beside, height / ratio);
  const double panel = std::max(kLeastPanel, beside + width);
  return fmt::format(
      "<figure style=\"width:{0:.0f}px\"><figcaption>{2}</figcaption><svg class=\"map\" "
      "width=\"{0:.0f}\" height=\"{1:.0f}\" role=\"img\" aria-label=\"{2}\">"
      "<image x=\"{3:.0f}\" width=\"{4:.1f}\" height=\"{5:.1f}\" preserveAspectRatio=\"none\" "
      "xlink:href=\"data:image/png;base64,{6}\"/>{7}{8}</svg>{9}</figure>\n",
      panel, height + (bare ? 0 : kBelow), escaped(map.title), beside, width, height,
      base64(png_of(map)), axis_svg(map.across, false, width, height),
      axis_svg(map.up, true, width, height), colour_bar(map));
}

constexpr std::string_view kStyle =
    "body{font:15px/1.5 sans-serif;max-width:62rem;margin:2rem auto;padding:0 1rem;color:#222}"
    "table{border-collapse:collapse}td{padding:.15rem 1rem .15rem 0;vertical-align:top}"
    "td:first-child{color:#666}.maps{display:flex;flex-wrap:wrap;gap:1.2rem}"
    "figure{margin:0}figcaption{font-weight:600}"
    ".map{display:block;font-size:12px;fill:#444;overflow:visible}.map path{stroke:#444}"
    ".map image{image-rendering:pixelated;outline:1px solid #ccc}"
    ".bar{width:100%;height:10px;display:block;margin-top:4px}"
    ".scale{display:flex;justify-content:space-between;font-size:13px;color:#666}"
    ".plot{width:100%}";

}  // namespace

void HtmlPage::heading(const std::string& text) {
  body_ += "<h2>" + escaped(text) + "</h2>\n";
}

void HtmlPage::paragraph(const std::string& text) {
  body_ += "<p>" + escaped(text) + "</p>\n";
}

void HtmlPage::table(const std::vector<std::pair<std::string, std::string>>& lines) {
  body_ += "<table>\n";
  for (const auto& [label, text] : lines)
    body_ += "<tr><td>" + escaped(label) + "</td><td>" + escaped(text) + "</td></tr>\n";
  body_ += "</table>\n";
}

void HtmlPage::plots(const std::vector<Plot>& plots, int columns) {
  // As a picture of its own: names within an SVG would clash with those of the next one.
  body_ += "<img class=\"plot\" alt=\"plots\" src=\"data:image/svg+xml;base64," +
           base64(plot_svg(plots, columns)) + "\">\n";
}

void HtmlPage::heat_maps(const std::vector<HeatMap>& maps) {
  body_ += "<div class=\"maps\">\n";
  for (const HeatMap& map : maps) body_ += figure_of(map);
  body_ += "</div>\n";
}

std::string HtmlPage::text() const {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{0}</title>\n"
      "<style>{1}</style>\n</head>\n<body>\n<h1>{0}</h1>\n{2}</body>\n</html>\n",
      escaped(title_), kStyle, body_);
}

}  // namespace plenoflame::cli
