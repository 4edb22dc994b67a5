#include "plot.h"

#include <cairo-svg.h>
#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string_view>
#include <utility>

#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/math/readable.h"

namespace plenoflame {
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

/// One axis: from `low` to `high` (decimal logarithms on a logarithmic one) onto pixels.
struct Axis {
  double low = 0, high = 1, begin = 0, end = 1;
  bool logarithmic = true;
  double place(double value) const { return logarithmic ? std::log10(value) : value; }
  double at(double value) const {
    return begin + (place(value) - low) / (high - low) * (end - begin);
  }
  double step() const { return tick_step(high - low, 7); }
};

Axis axis_over(const Plot& plot, bool x, double begin, double end) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  Axis axis{0, 1, begin, end, x ? plot.log_x : plot.log_y};
  for (const PlotSeries& series : plot.series)
    for (const auto& point : series.points) {
      const double value = axis.place(x ? point.first : point.second);
      if (!std::isfinite(value)) continue;
      low = std::min(low, value), high = std::max(high, value);
    }
  if (!(low <= high)) low = high = 0;
  if (axis.logarithmic) {
    // Whole thirds of decades (1, 2, 5), with some room.
    axis.low = std::floor(3 * (low - 0.05)) / 3, axis.high = std::ceil(3 * (high + 0.05)) / 3;
    return axis;
  }
  // All values alike: some room around them, so that the axis has a length.
  const double room = high > low ? 0.04 * (high - low) : high != 0 ? 0.1 * std::fabs(high) : 1;
  axis.low = low - room, axis.high = high + room;
  if (low >= 0 && axis.low < 0) axis.low = 0;
  return axis;
}

std::string number_text(double value) {
  char text[32];
  const double size = std::fabs(value);
  const bool plain = size == 0 || (size >= 1e-4 && size < 1e5);
  std::snprintf(text, sizeof text, plain ? "%.6g" : "%.3g", value);
  return text;
}

class Painter {
 public:
  Painter(cairo_t* context, const Plot& plot)
      : c_(context),
        plot_(plot),
        x_(axis_over(plot, true, kLeft, kWidth - kRight)),
        y_(axis_over(plot, false, kHeight - kBottom, kTop)) {
    if (!plot.equal_scales) return;
    const double across = (x_.high - x_.low) / std::fabs(x_.end - x_.begin);
    const double up = (y_.high - y_.low) / std::fabs(y_.end - y_.begin);
    Axis& shorter = across < up ? x_ : y_;
    const double grow = std::max(across, up) / std::min(across, up);
    const double middle = 0.5 * (shorter.low + shorter.high);
    const double half = 0.5 * (shorter.high - shorter.low) * grow;
    shorter.low = middle - half, shorter.high = middle + half;
  }

  void paint() {
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

  /// A line of the grid, and its label if it has one.
  void rule(bool horizontal, double at, double shade, const std::string& label) {
    cairo_set_source_rgb(c_, shade, shade, shade);
    cairo_set_line_width(c_, 1);
    if (horizontal)
      line(at, kTop, at, kHeight - kBottom);
    else
      line(kLeft, at, kWidth - kRight, at);
    if (label.empty()) return;
    cairo_set_source_rgb(c_, 0, 0, 0);
    if (horizontal)
      text(label, at, kHeight - kBottom + 22, Align::centre);
    else
      text(label, kLeft - 8, at + 5, Align::right);
  }

  void grid() {
    for (const bool horizontal : {true, false}) {
      const Axis& axis = horizontal ? x_ : y_;
      if (!axis.logarithmic) {
        const double step = axis.step();
        for (double k = std::ceil(axis.low / step); k * step <= axis.high; ++k)
          rule(horizontal, axis.at(k * step), k == 0 ? 0.6 : 0.85, number_text(k * step + 0.0));
        continue;
      }
      // Few decades leave room for labels at 2 and 5.
      const bool all_labels = axis.high - axis.low < 2.5;
      for (int decade = static_cast<int>(std::floor(axis.low)); decade <= axis.high; ++decade)
        for (int digit = 1; digit < 10; ++digit) {
          const double value = digit * std::pow(10.0, decade), place = std::log10(value);
          if (place < axis.low - 0.01 || place > axis.high + 0.01) continue;
          const double at = axis.at(value);
          const bool labelled = digit == 1 || (all_labels && (digit == 2 || digit == 5));
          rule(horizontal, at, digit == 1 ? 0.72 : 0.9,
               labelled ? number_text(value) : std::string());
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
    if (series.style != PlotStyle::marks) {
      set_dash(series);
      for (const auto& point : series.points) {
        const double x = x_.at(point.first), y = y_.at(point.second);
        if (std::isfinite(x) && std::isfinite(y))
          cairo_line_to(c_, x, y);
        else
          cairo_new_sub_path(c_);
      }
      cairo_stroke(c_);
      cairo_set_dash(c_, nullptr, 0, 0);
    }
    if (series.style != PlotStyle::marks && series.style != PlotStyle::line_with_marks) return;
    for (const auto& point : series.points) {
      const double x = x_.at(point.first), y = y_.at(point.second);
      if (std::isfinite(x) && std::isfinite(y)) mark(series, x, y);
    }
  }

  void set_dash(const PlotSeries& series) {
    const double dashes[] = {7, 5};
    if (series.style == PlotStyle::dashed) cairo_set_dash(c_, dashes, 2, 0);
  }

  void mark(const PlotSeries& series, double x, double y) {
    const double crowded = series.points.size() > 100 ? 1.6 : 4.5;
    cairo_arc(c_, x, y, crowded, 0, 2 * 3.14159265358979);
    cairo_fill(c_);
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

  /// The amount of lines and marks that lies under a rectangle.
  double hidden(double left, double top, double width, double height) const {
    double sum = 0;
    for (const PlotSeries& series : plot_.series)
      for (std::size_t i = 0; i < series.points.size(); ++i) {
        const double x = x_.at(series.points[i].first), y = y_.at(series.points[i].second);
        const std::size_t before = i > 0 ? i - 1 : 0;
        const double from_x = x_.at(series.points[before].first),
                     from_y = y_.at(series.points[before].second);
        constexpr int kSteps = 16;
        for (int k = 1; k <= kSteps; ++k) {
          const double at_x = from_x + (x - from_x) * k / kSteps - left,
                       at_y = from_y + (y - from_y) * k / kSteps - top;
          if (at_x > 0 && at_x < width && at_y > 0 && at_y < height) sum += 1;
        }
      }
    return sum;
  }

  /// Left and top of the rectangle in that corner of the picture where it hides least.
  std::pair<double, double> free_corner(double width, double height) const {
    constexpr double kGap = 12;
    std::pair<double, double> best;
    double least = std::numeric_limits<double>::infinity();
    for (const double top : {kTop + kGap, kHeight - kBottom - kGap - height})
      for (const double left : {kWidth - kRight - kGap - width, kLeft + kGap})
        if (const double lost = hidden(left, top, width, height); lost < least)
          least = lost, best = {left, top};
    return best;
  }

  void legend() {
    double width = 0;
    std::vector<const PlotSeries*> shown;
    for (const PlotSeries& series : plot_.series) {
      if (series.points.empty() || series.name.empty()) continue;
      cairo_text_extents_t size;
      cairo_text_extents(c_, series.name.c_str(), &size);
      width = std::max(width, size.x_advance);
      shown.push_back(&series);
    }
    if (shown.empty()) return;
    const double height = 24 * static_cast<double>(shown.size()) + 12;
    const auto [left, top] = free_corner(width + 56, height);
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
      set_dash(*series);
      if (series->style != PlotStyle::marks) line(left + 10, y, left + 38, y);
      cairo_set_dash(c_, nullptr, 0, 0);
      if (series->style == PlotStyle::marks || series->style == PlotStyle::line_with_marks)
        mark(*series, left + 24, y);
      cairo_set_source_rgb(c_, 0, 0, 0);
      text(series->name, left + 46, y + 5, Align::left);
      y += 24;
    }
  }

  cairo_t* c_;
  const Plot& plot_;
  Axis x_, y_;
};

int row_count(const std::vector<Plot>& plots, int columns) {
  return (static_cast<int>(plots.size()) + columns - 1) / columns;
}

void paint(cairo_t* context, const std::vector<Plot>& plots, int columns) {
  cairo_set_source_rgb(context, 1, 1, 1);
  cairo_paint(context);
  for (std::size_t k = 0; k < plots.size(); ++k) {
    const int place = static_cast<int>(k);
    cairo_save(context);
    cairo_translate(context, place % columns * kWidth, place / columns * kHeight);
    Painter(context, plots[k]).paint();
    cairo_restore(context);
  }
}

}  // namespace

std::string plot_svg(const std::vector<Plot>& plots, int columns) {
  std::string bytes;
  const Surface surface(cairo_svg_surface_create_for_stream(append, &bytes, columns * kWidth,
                                                            row_count(plots, columns) * kHeight));
  const Context context(cairo_create(surface.get()));
  paint(context.get(), plots, columns);
  check(cairo_status(context.get()), "SVG");
  cairo_surface_finish(surface.get());
  check(cairo_surface_status(surface.get()), "SVG");
  return bytes;
}

void write_plot_svg(const std::string& path, const std::vector<Plot>& plots, int columns) {
  write_file(path, plot_svg(plots, columns));
}

void write_plot_png(const std::string& path, const std::vector<Plot>& plots, int columns) {
  // Several panels are for comparing: half the resolution will do.
  const double scale = plots.size() > 1 ? 1 : kPngScale;
  const Surface surface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(scale * columns * kWidth),
                                 static_cast<int>(scale * row_count(plots, columns) * kHeight)));
  const Context context(cairo_create(surface.get()));
  cairo_scale(context.get(), scale, scale);
  paint(context.get(), plots, columns);
  check(cairo_status(context.get()), path);
  std::string bytes;
  check(cairo_surface_write_to_png_stream(surface.get(), append, &bytes), path);
  write_file(path, bytes);
}

void write_plot(const std::string& path, const std::vector<Plot>& plots, int columns) {
  if (path.ends_with(".svg"))
    write_plot_svg(path, plots, columns);
  else if (path.ends_with(".png"))
    write_plot_png(path, plots, columns);
  else
    throw UsageError(path + ": a plot is written as .png or .svg");
}

}  // namespace plenoflame
