#include "plot.h"

#include <cairo-svg.h>
#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string_view>

#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"

namespace plenoflame::cli {
namespace {

constexpr double kWidth = 900, kHeight = 620, kPngScale = 2;
constexpr double kLeft = 95, kRight = 30, kTop = 55, kBottom = 75;
constexpr double kFontSize = 15;

struct SurfaceDeleter {
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
};
struct ContextDeleter {
  void operator()(cairo_t* context) const { cairo_destroy(context); }
};
using Surface = std::unique_ptr<cairo_surface_t, SurfaceDeleter>;
using Context = std::unique_ptr<cairo_t, ContextDeleter>;

cairo_status_t append(void* text, const unsigned char* data, unsigned int length) {
  static_cast<std::string*>(text)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
}

void check(cairo_status_t status, const std::string& path) {
  if (status != CAIRO_STATUS_SUCCESS)
    throw FileError(path + ": cannot draw the plot: " + cairo_status_to_string(status));
}

/// One logarithmic axis: from `low` to `high` (powers of ten) onto pixels.
struct Axis {
  double low = 0, high = 1, begin = 0, end = 1;
  double at(double value) const {
    return begin + (std::log10(value) - low) / (high - low) * (end - begin);
  }
};

Axis axis_over(const LogLogPlot& plot, bool x, double begin, double end) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const PlotSeries& series : plot.series)
    for (const auto& point : series.points) {
      const double value = std::log10(x ? point.first : point.second);
      low = std::min(low, value), high = std::max(high, value);
    }
  if (!(low <= high)) low = high = 0;
  // Whole thirds of decades (1, 2, 5), with some room.
  low = std::floor(3 * (low - 0.05)) / 3, high = std::ceil(3 * (high + 0.05)) / 3;
  return {low, high, begin, end};
}

std::string number_text(double value) {
  char text[32];
  const bool plain = value >= 1e-4 && value < 1e5;
  std::snprintf(text, sizeof text, plain ? "%.4g" : "%.0e", value);
  return text;
}

class Painter {
 public:
  Painter(cairo_t* context, const LogLogPlot& plot)
      : c_(context),
        plot_(plot),
        x_(axis_over(plot, true, kLeft, kWidth - kRight)),
        y_(axis_over(plot, false, kHeight - kBottom, kTop)) {}

  void paint() {
    cairo_set_source_rgb(c_, 1, 1, 1);
    cairo_paint(c_);
    cairo_select_font_face(c_, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(c_, kFontSize);
    grid();
    cairo_save(c_);
    cairo_rectangle(c_, kLeft, kTop, kWidth - kLeft - kRight, kHeight - kTop - kBottom);
    cairo_clip(c_);
    for (const PlotGuide& guide : plot_.guides) draw(guide);
    for (const PlotSeries& series : plot_.series) draw(series);
    cairo_restore(c_);
    frame();
    legend();
  }

 private:
  enum class Align { left, centre, right };

  void text(const std::string& words, double x, double y, Align align) {
    cairo_text_extents_t size;
    cairo_text_extents(c_, words.c_str(), &size);
    const double share = align == Align::left ? 0 : align == Align::centre ? 0.5 : 1;
    cairo_move_to(c_, x - share * size.x_advance, y);
    cairo_show_text(c_, words.c_str());
    cairo_new_path(c_);  // the text left a point behind
  }

  void line(double x0, double y0, double x1, double y1) {
    cairo_move_to(c_, x0, y0);
    cairo_line_to(c_, x1, y1);
    cairo_stroke(c_);
  }

  void grid() {
    for (const bool horizontal : {true, false}) {
      const Axis& axis = horizontal ? x_ : y_;
      // Where there are few decades 2 and 5 are labelled as well.
      const bool all_labels = axis.high - axis.low < 2.5;
      for (int decade = static_cast<int>(std::floor(axis.low)); decade <= axis.high; ++decade)
        for (int digit = 1; digit < 10; ++digit) {
          const double value = digit * std::pow(10.0, decade), place = std::log10(value);
          if (place < axis.low - 0.01 || place > axis.high + 0.01) continue;
          const double at = axis.at(value);
          const double shade = digit == 1 ? 0.72 : 0.9;
          cairo_set_source_rgb(c_, shade, shade, shade);
          cairo_set_line_width(c_, 1);
          if (horizontal)
            line(at, kTop, at, kHeight - kBottom);
          else
            line(kLeft, at, kWidth - kRight, at);
          if (digit != 1 && !(all_labels && (digit == 2 || digit == 5))) continue;
          cairo_set_source_rgb(c_, 0, 0, 0);
          if (horizontal)
            text(number_text(value), at, kHeight - kBottom + 22, Align::centre);
          else
            text(number_text(value), kLeft - 8, at + 5, Align::right);
        }
    }
  }

  void draw(const PlotGuide& guide) {
    const auto y_at = [&](double log_x) {
      return guide.y * std::pow(10.0, guide.slope * (log_x - std::log10(guide.x)));
    };
    cairo_set_source_rgb(c_, 0.45, 0.45, 0.45);
    cairo_set_line_width(c_, 1.2);
    const double dashes[] = {6, 5};
    cairo_set_dash(c_, dashes, 2, 0);
    line(x_.begin, y_.at(y_at(x_.low)), x_.end, y_.at(y_at(x_.high)));
    cairo_set_dash(c_, nullptr, 0, 0);
    // The name stands above the line's beginning, or where that is within the picture with room for
    // it.
    const double highest =
        y_.low + (kTop + 26 - y_.begin) / (y_.end - y_.begin) * (y_.high - y_.low);
    const double log_x =
        std::max(x_.low, std::log10(guide.x) + (highest - std::log10(guide.y)) / guide.slope);
    const double x = x_.begin + (log_x - x_.low) / (x_.high - x_.low) * (x_.end - x_.begin);
    text(guide.name, x + 8, y_.at(y_at(log_x)) - 6, Align::left);
  }

  void draw(const PlotSeries& series) {
    cairo_set_source_rgb(c_, series.colour[0], series.colour[1], series.colour[2]);
    cairo_set_line_width(c_, 2.2);
    for (const auto& point : series.points)
      cairo_line_to(c_, x_.at(point.first), y_.at(point.second));
    cairo_stroke(c_);
    for (const auto& point : series.points) {
      cairo_arc(c_, x_.at(point.first), y_.at(point.second), 4.5, 0, 2 * 3.14159265358979);
      cairo_fill(c_);
    }
  }

  void frame() {
    cairo_set_source_rgb(c_, 0, 0, 0);
    cairo_set_line_width(c_, 1.2);
    cairo_rectangle(c_, kLeft, kTop, kWidth - kLeft - kRight, kHeight - kTop - kBottom);
    cairo_stroke(c_);
    text(plot_.x_label, 0.5 * (kLeft + kWidth - kRight), kHeight - 22, Align::centre);
    cairo_save(c_);
    cairo_translate(c_, 26, 0.5 * (kTop + kHeight - kBottom));
    cairo_rotate(c_, -0.5 * 3.14159265358979);
    text(plot_.y_label, 0, 0, Align::centre);
    cairo_restore(c_);
    cairo_set_font_size(c_, 1.15 * kFontSize);
    text(plot_.title, 0.5 * (kLeft + kWidth - kRight), 34, Align::centre);
    cairo_set_font_size(c_, kFontSize);
  }

  void legend() {
    double width = 0;
    std::vector<const PlotSeries*> shown;
    for (const PlotSeries& series : plot_.series) {
      if (series.points.empty()) continue;
      cairo_text_extents_t size;
      cairo_text_extents(c_, series.name.c_str(), &size);
      width = std::max(width, size.x_advance);
      shown.push_back(&series);
    }
    if (shown.empty()) return;
    const double height = 24 * static_cast<double>(shown.size()) + 12;
    const double left = kWidth - kRight - width - 68, top = kTop + 12;
    cairo_set_source_rgb(c_, 1, 1, 1);
    cairo_rectangle(c_, left, top, width + 56, height);
    cairo_fill_preserve(c_);
    cairo_set_source_rgb(c_, 0.6, 0.6, 0.6);
    cairo_set_line_width(c_, 1);
    cairo_stroke(c_);
    double y = top + 18;
    for (const PlotSeries* series : shown) {
      cairo_set_source_rgb(c_, series->colour[0], series->colour[1], series->colour[2]);
      cairo_set_line_width(c_, 2.2);
      line(left + 10, y, left + 38, y);
      cairo_arc(c_, left + 24, y, 4.5, 0, 2 * 3.14159265358979);
      cairo_fill(c_);
      cairo_set_source_rgb(c_, 0, 0, 0);
      text(series->name, left + 46, y + 5, Align::left);
      y += 24;
    }
  }

  cairo_t* c_;
  const LogLogPlot& plot_;
  Axis x_, y_;
};

}  // namespace

void write_plot_svg(const std::string& path, const LogLogPlot& plot) {
  std::string bytes;
  const Surface surface(cairo_svg_surface_create_for_stream(append, &bytes, kWidth, kHeight));
  const Context context(cairo_create(surface.get()));
  Painter(context.get(), plot).paint();
  check(cairo_status(context.get()), path);
  cairo_surface_finish(surface.get());
  check(cairo_surface_status(surface.get()), path);
  write_file(path, bytes);
}

void write_plot_png(const std::string& path, const LogLogPlot& plot) {
  const Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24,
                                                   static_cast<int>(kPngScale * kWidth),
                                                   static_cast<int>(kPngScale * kHeight)));
  const Context context(cairo_create(surface.get()));
  cairo_scale(context.get(), kPngScale, kPngScale);
  Painter(context.get(), plot).paint();
  check(cairo_status(context.get()), path);
  std::string bytes;
  check(cairo_surface_write_to_png_stream(surface.get(), append, &bytes), path);
  write_file(path, bytes);
}

}  // namespace plenoflame::cli
