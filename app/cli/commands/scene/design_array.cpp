#include "commands/scene/design_array.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "camera_optimizer.h"
#include "options.h"
#include "plenoflame/base/error.h"
#include "plenoflame/scene/design_report.h"
#include "plenoflame/scene/scene_file.h"

namespace plenoflame::cli {
namespace {

nlohmann::json range_json(const SharpRange& range) {
  return {range.near, range.focus, range.far};
}

MicrolensShape shape_of(const ArraySpec& array, const MicrolensSpec& type) {
  return {type.radius_front, type.radius_back, type.index, array.thickness};
}

}  // namespace

std::vector<SolvedType> solve_for_array(const ArrayTask& task, const Scene& scene, Report& report) {
  const ArraySpec& array = scene.camera.array;
  if (!array.present)
    throw UsageError("--solve: the scene's camera has no microlens array to start from");
  MicrolensLimits limits;
  limits.greatest_index = task.index_limit;
  if (!task.least_radius.empty())
    limits.least_radius = quantity_option("--least-radius", task.least_radius, Dimension::length);
  if (!task.greatest_thickness.empty())
    limits.greatest_thickness =
        quantity_option("--greatest-thickness", task.greatest_thickness, Dimension::length);
  const auto types = solve_array(array, scene.camera.sensor.pixel_pitch, task.types,
                                 freedom_named(task.freedom), limits);
  nlohmann::json rows = nlohmann::json::array();
  for (std::size_t k = 0; k < types.size(); ++k) {
    const SolvedType& type = types[k];
    const MicrolensShape& s = type.shape;
    report.add_text("solved type " + std::to_string(k + 1),
                    "focal length " + length_text(type.target) + ": index " +
                        readable(s.index, Dimension::none) + ", radii " +
                        length_text(s.radius_front) + " and " + length_text(s.radius_back) +
                        ", thickness " + length_text(s.thickness));
    report.add_text("  by the rule",
                    "sharp from " + array_range_text(type.rule.near, type.rule.far));
    report.add_text("  by rays", type.traced ? "sharp from " + array_range_text(type.traced->near,
                                                                                type.traced->far)
                                             : "never sharp to a pixel");
    nlohmann::json row = {{"focal_length_m", type.target},
                          {"index", s.index},
                          {"radius_front_m", s.radius_front},
                          {"radius_back_m", s.radius_back},
                          {"thickness_m", s.thickness},
                          {"rule_m", range_json(type.rule)},
                          {"traced_m", nullptr}};
    if (type.traced) row["traced_m"] = range_json(*type.traced);
    if (k > 0 && type.traced && types[k - 1].traced) {
      // In dioptres, of the width of one type: where the nearer range ends and the other begins.
      const double width = 1 / type.rule.near - 1 / type.rule.far;
      const double gap = (1 / type.traced->far - 1 / types[k - 1].traced->near) / width;
      report.add_text("  joins type " + std::to_string(k),
                      readable_percent(std::fabs(gap)) + " of a range " +
                          (gap > 0 ? "apart" : "overlapping") + ", by rays");
      row["gap_share"] = gap;
    }
    rows.push_back(std::move(row));
  }
  report.add_json("solved", rows);
  return types;
}

Scene with_solved_array(const Scene& scene, const std::vector<SolvedType>& types,
                        MicrolensFreedom freedom) {
  if (freedom == MicrolensFreedom::thickness)
    throw UsageError(
        "--output: all types of a scene have the same thickness; choose index or radius");
  Scene solved = scene;
  std::vector<MicrolensSpec>& specs = solved.camera.array.types;
  specs.resize(types.size());
  for (std::size_t k = 0; k < types.size(); ++k) {
    MicrolensSpec& spec = specs[k];
    if (spec.name.empty()) spec.name = "type" + std::to_string(k + 1);
    spec.radius_front = types[k].shape.radius_front;
    spec.radius_back = types[k].shape.radius_back;
    spec.index = types[k].shape.index;
    spec.focal_length = 0;
  }
  // The microlens type that was in focus may be gone.
  std::string& conjugate = solved.camera.focus.conjugate;
  const bool known = std::any_of(specs.begin(), specs.end(),
                                 [&](const MicrolensSpec& spec) { return spec.name == conjugate; });
  if (!known && conjugate != "array") conjugate = specs.front().name;
  return solved;
}

std::vector<Plot> microlens_plots(const ArraySpec& array, const std::vector<SolvedType>& types,
                                  const std::string& freedom) {
  constexpr int kPoints = 200;
  const MicrolensShape first = shape_of(array, array.types.front());
  const double curved = std::min(std::fabs(first.radius_front), std::fabs(first.radius_back));
  struct Panel {
    std::string name, label;
    double from, to;
  };
  const double least_scale = 0.5 * array.diameter / curved;
  const Panel panels[] = {{"index", "index", 1.3, 2.2},
                          {"radius", "radius of the faces [mm]", std::max(0.4, least_scale), 2.2},
                          {"thickness", "thickness [mm]", 0, 4}};
  std::vector<Plot> plots;
  for (const Panel& panel : panels) {
    const auto shaped = [&](double value) {
      MicrolensShape shape = first;
      if (panel.name == "index") shape.index = value;
      if (panel.name == "radius") shape.radius_front *= value, shape.radius_back *= value;
      if (panel.name == "thickness") shape.thickness *= value;
      return shape;
    };
    const auto across = [&](const MicrolensShape& shape) {
      const double radius = std::min(std::fabs(shape.radius_front), std::fabs(shape.radius_back));
      return panel.name == "index"    ? shape.index
             : panel.name == "radius" ? 1e3 * radius
                                      : 1e3 * shape.thickness;
    };
    Plot plot;
    plot.title = "Focal length against " + panel.name;
    plot.x_label = panel.label;
    plot.y_label = "focal length [mm]";
    plot.log_x = plot.log_y = false;
    const bool marked = panel.name == freedom;
    PlotSeries curve{
        marked ? "first type, all else as it is" : "", {}, plot_colour(1), PlotStyle::line};
    for (int i = 0; i <= kPoints; ++i) {
      const MicrolensShape shape = shaped(panel.from + (panel.to - panel.from) * i / kPoints);
      const double f = thick_focal_length(shape);
      if (f > 0) curve.points.emplace_back(across(shape), 1e3 * f);
    }
    PlotSeries marks{"solved types", {}, plot_colour(0), PlotStyle::marks};
    if (marked)
      for (const SolvedType& type : types)
        marks.points.emplace_back(across(type.shape), 1e3 * type.target);
    plot.series = {curve, marks};
    plots.push_back(std::move(plot));
  }
  return plots;
}

}  // namespace plenoflame::cli
