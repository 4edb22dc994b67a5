#pragma once
#include <array>
#include <string>
#include <utility>
#include <vector>

namespace plenoflame {

/// The way in which the points of a series are drawn.
enum class PlotStyle { line_with_marks, line, dashed, marks };

/// One line of a plot. On a logarithmic axis its values are positive. A point that is not finite
/// interrupts the line.
struct PlotSeries {
  std::string name;
  std::vector<std::pair<double, double>> points;
  std::array<double, 3> colour{};  ///< red, green, blue, 0 to 1
  PlotStyle style = PlotStyle::line_with_marks;
};

/// A straight line through a point with a given exponent, drawn faintly: y ~ x^slope.
struct PlotGuide {
  std::string name;
  double x = 1, y = 1, slope = 0;
};

/// A plot; its axes are logarithmic, with labelled decades, or linear.
struct Plot {
  std::string title, x_label, y_label;
  std::vector<PlotSeries> series;
  std::vector<PlotGuide> guides;  ///< only where both axes are logarithmic
  bool log_x = true, log_y = true;
  bool equal_scales = false;  ///< a unit is as long across as up (linear axes)
};

/// The colour of the k-th series where nothing better is known.
std::array<double, 3> plot_colour(std::size_t k);

/// Writes the plots as a file, each 900 x 620 points, from left to right in `columns` columns. Text
/// is drawn as outlines, so that it looks alike everywhere. Series without a point are left out.
/// @throws FileError
void write_plot_svg(const std::string& path, const std::vector<Plot>& plots, int columns = 1);
/// The same as text.
std::string plot_svg(const std::vector<Plot>& plots, int columns = 1);
void write_plot_png(const std::string& path, const std::vector<Plot>& plots, int columns = 1);
/// The kind that the name's end says: .png or .svg. @throws UsageError for another
void write_plot(const std::string& path, const std::vector<Plot>& plots, int columns = 1);

}  // namespace plenoflame
