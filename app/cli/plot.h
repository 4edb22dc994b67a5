#pragma once
#include <array>
#include <string>
#include <utility>
#include <vector>

namespace plenoflame::cli {

/// One line with marks of a plot, of positive values.
struct PlotSeries {
  std::string name;
  std::vector<std::pair<double, double>> points;
  std::array<double, 3> colour{};  ///< red, green, blue, 0 to 1
};

/// A straight line through a point with a given exponent, drawn faintly: y ~ x^slope.
struct PlotGuide {
  std::string name;
  double x = 1, y = 1, slope = 0;
};

/// A plot with logarithmic axes, decades labelled.
struct LogLogPlot {
  std::string title, x_label, y_label;
  std::vector<PlotSeries> series;
  std::vector<PlotGuide> guides;
};

/// The plot as files of 900 x 620 points; text is drawn as outlines, so that it looks alike
/// everywhere. Series without a point are left out. @throws FileError
void write_plot_svg(const std::string& path, const LogLogPlot& plot);
void write_plot_png(const std::string& path, const LogLogPlot& plot);

}  // namespace plenoflame::cli
