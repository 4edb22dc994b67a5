#include "commands/reconstruct/reconstruct_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "html_page.h"
#include "slice_values.h"

namespace plenoflame::cli {
namespace {

/// A plane of unknowns: across and up are axes of their numbering.
struct Slice {
  std::string name;  ///< after that of a field; empty: there is no other
  std::size_t across, up;
  std::array<int, 3> at;  ///< index of the plane along the third axis
};

/// Planes through the unknown that shines most; of rings there is one, of layers none.
std::vector<Slice> slices(const Unknowns& unknowns, const std::vector<double>& emission) {
  const std::array<int, 3> shape = unknowns.shape();
  const auto brightest = static_cast<std::size_t>(
      std::max_element(emission.begin(), emission.end()) - emission.begin());
  const auto n1 = static_cast<std::size_t>(shape[1]), n2 = static_cast<std::size_t>(shape[2]);
  const std::array<int, 3> at{static_cast<int>(brightest / (n1 * n2)),
                              static_cast<int>(brightest / n2 % n1),
                              static_cast<int>(brightest % n2)};
  if (shape[1] < 2) return {};
  if (shape[2] < 2) return {{"", 0, 1, at}};
  return {{", front", 1, 2, at}, {", side", 0, 2, at}, {", from above", 0, 1, at}};
}

/// The axis of the unknowns along a side of a slice, in mm.
SliceAxis axis_of(const Unknowns& unknowns, const Slice& slice, std::size_t side) {
  const std::array<int, 3> shape = unknowns.shape();
  if (unknowns.begins_at_centre()) {
    const double spacing = 1e3 * unknowns.spacing()[side];
    return {side == 0 ? "radius [mm]" : "height [mm]", -0.5 * spacing,
            (shape[side] - 0.5) * spacing};
  }
  std::array<int, 3> from = slice.at, to = slice.at;
  from[side] = 0, to[side] = shape[side] - 1;
  const auto place = [&](const std::array<int, 3>& at) {
    return unknowns.place(static_cast<std::size_t>((at[0] * shape[1] + at[1]) * shape[2] + at[2]));
  };
  const Vec3 first = place(from);
  return slice_axis(first, normalize(place(to) - first), unknowns.spacing()[side], shape[side]);
}

/// The values of a plane, without title, unit and limits.
HeatMap map_of(const Unknowns& unknowns, const std::vector<double>& values, const Slice& slice) {
  const std::array<int, 3> shape = unknowns.shape();
  HeatMap map;
  map.width = shape[slice.across];
  map.height = shape[slice.up];
  map.aspect = unknowns.spacing()[slice.up] / unknowns.spacing()[slice.across];
  map.across = axis_of(unknowns, slice, slice.across);
  map.up = axis_of(unknowns, slice, slice.up);
  for (int row = map.height - 1; row >= 0; --row)
    for (int column = 0; column < map.width; ++column) {
      std::array<int, 3> at = slice.at;
      at[slice.across] = column;
      at[slice.up] = row;
      map.values.push_back(
          values[static_cast<std::size_t>((at[0] * shape[1] + at[1]) * shape[2] + at[2])]);
    }
  return map;
}

struct Field {
  std::string name, unit;
  const std::vector<double>& found;
  const std::vector<double>& deviation;  ///< empty: not known
  const std::vector<double>* truth = nullptr;
  /// Known only in lit places; its colours begin at the least value.
  bool of_light = false;
};

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Takes values away where the deviation of `found` is a half of it or more.
void hide_unknown(std::vector<double>& values, const std::vector<double>& found,
                  const std::vector<double>& deviation) {
  constexpr double kHardlyKnown = 0.5;
  for (std::size_t j = 0; j < deviation.size(); ++j)
    if (found[j] > 0 && deviation[j] > kHardlyKnown * found[j]) values[j] = kNaN;
}

std::array<double, 2> range_of(const std::vector<double>& values) {
  std::array<double, 2> range{1e300, -1e300};
  for (const double value : values)
    if (std::isfinite(value)) range = {std::min(range[0], value), std::max(range[1], value)};
  return range;
}

/// The value, its deviation and its error beside the truth, the last two on one scale.
void add_field(HtmlPage& html, const ReconstructPage& page, const Field& field) {
  if (field.found.empty()) return;
  const std::vector<double>& emission = page.result.estimate.emission;
  std::vector<double> known = field.found, deviation = field.deviation,
                      truth = field.truth ? *field.truth : std::vector<double>{};
  hide_unknown(known, field.found, field.deviation);
  if (field.of_light)
    for (std::vector<double>* values : {&known, &deviation, &truth}) {
      if (values->empty()) continue;
      hide_unknown(*values, emission, page.result.estimate.emission_deviation);
      for (std::size_t j = 0; j < emission.size(); ++j)
        if (!(emission[j] > 0)) (*values)[j] = kNaN;
    }
  const auto [low_shown, high] = range_of(truth.empty() ? known : truth);
  const double low = field.of_light ? std::min(low_shown, range_of(known)[0]) : 0;
  if (!(high > low)) return;
  const std::vector<double> errors = truth.empty() ? truth : errors_of(known, truth);
  const double reach =
      std::max(size_where_lit(deviation, emission), size_where_lit(errors, emission));
  for (const Slice& slice : slices(page.unknowns, emission)) {
    const auto map = [&](const std::string& title, const std::vector<double>& values, double bottom,
                         double top) {
      HeatMap made = map_of(page.unknowns, values, slice);
      made.title = title;
      made.unit = field.unit;
      made.low = bottom;
      made.high = top;
      return made;
    };
    std::vector<HeatMap> maps{map(field.name + slice.name, known, low, high)};
    if (!deviation.empty()) maps.push_back(map("deviation", deviation, 0, reach));
    if (!truth.empty()) {
      maps.push_back(map("truth", truth, low, high));
      maps.push_back(map("error", errors, -reach, reach));
      maps.back().signed_values = true;
    }
    html.heat_maps(maps);
  }
}

Plot labelled(const std::string& title, const std::string& x, const std::string& y) {
  Plot plot;
  plot.title = title;
  plot.x_label = x;
  plot.y_label = y;
  return plot;
}

PlotSeries named(const std::string& name) {
  PlotSeries series;
  series.name = name;
  return series;
}

/// A plot for layers: values over the number of the layer.
void add_profile(HtmlPage& html, const ReconstructPage& page) {
  Plot plot = labelled("Emission from the middle outwards", "layer", "emission [W/(m^3 sr)]");
  plot.log_x = plot.log_y = false;
  const auto add = [&](const std::string& name, const std::vector<double>& values) {
    PlotSeries series = named(name);
    series.colour = plot_colour(plot.series.size());
    for (std::size_t j = 0; j < values.size(); ++j)
      series.points.emplace_back(static_cast<double>(j), values[j]);
    plot.series.push_back(series);
  };
  add("found", page.result.estimate.emission);
  if (page.truth) add("truth", page.truth->emission);
  html.plots({plot}, 1);
}

HeatMap picture_map(const std::string& title, const Image& image, double low, double high) {
  HeatMap map;
  map.title = title;
  map.unit = "W";
  map.width = image.width;
  map.height = image.height;
  map.low = low;
  map.high = high;
  for (int row = 0; row < image.height; ++row)
    for (int column = 0; column < image.width; ++column)
      map.values.push_back(static_cast<double>(image.at(column, row)));
  return map;
}

void add_pictures(HtmlPage& html, const ReconstructPage& page) {
  const Reconstruction& figures = page.result.figures;
  for (std::size_t v = 0; v < figures.residual.size(); ++v) {
    double high = 0;
    const Image& explained = figures.explained[v];
    for (int row = 0; row < explained.height; ++row)
      for (int column = 0; column < explained.width; ++column)
        high = std::max(high, static_cast<double>(explained.at(column, row)));
    const std::string name = v < page.pictures.size() ? page.pictures[v] : "";
    HeatMap left =
        picture_map("measured - explained", figures.residual[v], -0.1 * high, 0.1 * high);
    left.signed_values = true;
    html.heat_maps({picture_map(name + ": explained", explained, 0, high), left});
  }
}

Plot history_plot(const Reconstruction& figures) {
  Plot plot = labelled("History of the solution", "iteration", "chi^2 per row");
  PlotSeries series = named("chi^2 per row");
  series.colour = plot_colour(0);
  series.style = PlotStyle::line;
  for (std::size_t i = 0; i < figures.history.size(); ++i)
    if (figures.history[i] > 0)
      series.points.emplace_back(static_cast<double>(i + 1), figures.history[i]);
  plot.series.push_back(series);
  return plot;
}

std::vector<Plot> strength_plots(const Reconstruction& figures) {
  Plot misfit = labelled("Strengths that were tried", "strength", "chi^2 per row");
  Plot errors = labelled("Cross-validation", "strength", "expected error of a row left out");
  PlotSeries all = named("tried"), curve = all, chosen = named("chosen"), chosen_curve = chosen;
  all.colour = curve.colour = plot_colour(1);
  chosen.colour = chosen_curve.colour = plot_colour(0);
  chosen.style = chosen_curve.style = PlotStyle::marks;
  const auto rows = static_cast<double>(figures.rows - figures.left_out);
  for (const auto& trial : figures.trials) {
    all.points.emplace_back(trial.strength, trial.chi_squared);
    curve.points.emplace_back(trial.strength, std::sqrt(trial.gcv * rows));
    if (trial.strength != figures.strength) continue;
    chosen.points.push_back(all.points.back());
    chosen_curve.points.push_back(curve.points.back());
  }
  misfit.series = {all, chosen};
  errors.series = {curve, chosen_curve};
  return {misfit, errors};
}

}  // namespace

std::string reconstruct_page(const ReconstructPage& page) {
  const Reconstruction& figures = page.result.figures;
  const FlameEstimate& estimate = page.result.estimate;
  HtmlPage html("Reconstruction");
  std::vector<std::pair<std::string, std::string>> lines = page.report.lines();
  html.paragraph(lines.at(0).second);  // the verdict
  lines.erase(lines.begin());
  html.table(lines);
  html.heading("What was found");
  const FlameTruth* const truth = page.truth;
  if (page.unknowns.shape()[1] < 2) {
    add_profile(html, page);
  } else {
    const std::vector<double> none;
    add_field(html, page,
              {"temperature", "K", estimate.temperature, estimate.temperature_deviation,
               truth ? &truth->temperature : nullptr, true});
    add_field(html, page,
              {"emission", "W/(m^3 sr)", estimate.emission, estimate.emission_deviation,
               truth ? &truth->emission : nullptr});
    if (!estimate.absorption_deviation.empty())
      add_field(html, page,
                {"absorption", "1/m", estimate.absorption, estimate.absorption_deviation,
                 truth ? &truth->absorption : nullptr});
    add_field(html, page, {"resolved", "by the pictures", figures.resolved, none});
  }
  html.heading("What the pictures say of it");
  add_pictures(html, page);
  html.heading("How it was found");
  if (figures.trials.size() > 1) html.plots(strength_plots(figures), 2);
  if (!figures.history.empty()) html.plots({history_plot(figures)}, 1);
  return html.text();
}

}  // namespace plenoflame::cli
