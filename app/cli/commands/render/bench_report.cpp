#include "commands/render/bench_report.h"
#include "commands/render/estimator_name.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <sstream>
#include <thread>

#include "options.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/version.h"
#include "plenoflame/image/atomic_file.h"
#include "plot.h"

namespace plenoflame::cli {
namespace {

using Json = nlohmann::ordered_json;
constexpr int kFormat = 1;

std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.rfind("model name", 0) == 0 && line.find(": ") != std::string::npos)
      return line.substr(line.find(": ") + 2);
  return "unknown processor";
}

std::string today() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%d", &utc);
  return text;
}

std::string compiler() {
#if defined(__clang__)
  return "Clang " __clang_version__;
#else
  return "GCC " __VERSION__;
#endif
}

/// NaN and infinity have no JSON.
Json finite(double value) {
  return std::isfinite(value) ? Json(value) : Json();
}

Json point_json(const BenchmarkPoint& point) {
  const auto [least, most] = std::minmax_element(point.seconds.begin(), point.seconds.end());
  return {{"estimator", name_of(point.estimator)},
          {"samples", point.samples},
          {"relative_rmse", point.relative_rmse},
          {"relative_bias", point.relative_bias},
          {"relative_bias_error", point.relative_bias_error},
          {"local_slope", nullptr},
          {"seconds", point.median_seconds()},
          {"seconds_least", *least},
          {"seconds_most", *most},
          {"rays", point.rays},
          {"rays_per_second", point.rays_per_second()},
          {"efficiency", finite(point.efficiency())},
          {"gain_over_forward", nullptr},
          {"peak_memory", point.peak_memory}};
}

double number(const Json& value) {
  return value.is_number() ? value.get<double>() : std::nan("");
}

/// The value of a key of an object; null where there is none.
Json member(const Json& json, const char* key) {
  const auto found = json.is_object() ? json.find(key) : json.end();
  return json.is_object() && found != json.end() ? *found : Json();
}

/// Slopes between neighbours, and efficiencies in units of the forward estimator's (median).
void add_relations(Json& points) {
  std::vector<double> forward;
  for (const Json& point : points)
    if (point["estimator"] == "forward" && point["efficiency"].is_number())
      forward.push_back(number(point["efficiency"]));
  std::sort(forward.begin(), forward.end());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!forward.empty())
      points[i]["gain_over_forward"] =
          finite(number(points[i]["efficiency"]) / forward[forward.size() / 2]);
    if (i == 0 || points[i]["estimator"] != points[i - 1]["estimator"]) continue;
    points[i]["local_slope"] = finite(
        std::log(number(points[i]["relative_rmse"]) / number(points[i - 1]["relative_rmse"])) /
        std::log(number(points[i]["samples"]) / number(points[i - 1]["samples"])));
  }
}

std::string formatted(const char* format, double value) {
  if (!std::isfinite(value)) return "-";
  char text[48];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::string seconds_text(double value) {
  return formatted("%.3g s", value);
}

}  // namespace

Json bench_json(const BenchResult& result) {
  Json json;
  json["format"] = kFormat;
  json["kind"] = "plenoflame bench";
  json["version"] = version();
  json["date"] = today();
  json["machine"] = processor();
  json["processors"] = std::thread::hardware_concurrency();
  json["compiler"] = compiler();
  json["command"] = result.command;
  json["scene"] = result.scene;
  json["scene_text"] = result.scene_text;
  const PixelWindow& w = result.window;
  json["window"] = {w.x, w.y, w.width, w.height};
  json["threads"] = result.threads;
  json["repeat"] = result.repeat;
  json["reference"] = {{"samples", result.reference.light_field.samples},
                       {"relative_error", result.reference.relative_error},
                       {"cached", result.reference.cached},
                       {"seconds", result.reference.seconds},
                       {"file", result.reference.file}};
  json["fitted_slope"] = {{"backward", finite(fitted_slope(result.points, Estimator::backward))},
                          {"forward", finite(fitted_slope(result.points, Estimator::forward))}};
  Json points = Json::array();
  for (const BenchmarkPoint& point : result.points) points.push_back(point_json(point));
  add_relations(points);
  json["points"] = std::move(points);
  return json;
}

std::string bench_table(const Json& bench, std::size_t columns) {
  std::vector<std::vector<std::string>> rows{{"estimator", "samples", "RMSE", "bias", "+-", "slope",
                                              "time", "spread", "rays/s", "1/(e^2 t)", "gain",
                                              "memory"}};
  for (const Json& p : bench["points"])
    rows.push_back(
        {p["estimator"].get<std::string>(), formatted("%.6g", number(p["samples"])),
         number(p["relative_rmse"]) > 0 ? formatted("%.3g %%", 100 * number(p["relative_rmse"]))
                                        : "hidden",
         formatted("%+.2g %%", 100 * number(p["relative_bias"])),
         formatted("%.2g %%", 100 * number(p["relative_bias_error"])),
         formatted("%.2f", number(p["local_slope"])), seconds_text(number(p["seconds"])),
         formatted("%.0f %%", 100 * (number(p["seconds_most"]) - number(p["seconds_least"])) /
                                  number(p["seconds"])),
         formatted("%.3g", number(p["rays_per_second"])),
         formatted("%.3g", number(p["efficiency"])),
         formatted("%.3g", number(p["gain_over_forward"])),
         formatted("%.0f MB", number(p["peak_memory"]) / 1e6)});
  std::vector<std::size_t> widths(rows[0].size());
  for (const auto& row : rows)
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  std::ostringstream out;
  // As many columns beside one another as there is room for, each time behind the first two.
  constexpr std::size_t kNames = 2;
  for (std::size_t first = kNames, last = first; first < widths.size(); first = last) {
    std::size_t used = widths[0] + 2 + widths[1];
    do used += 2 + widths[last++];
    while (last < widths.size() && (columns == 0 || used + 2 + widths[last] <= columns));
    if (first > kNames) out << '\n';
    for (const auto& row : rows) {
      out << std::left << std::setw(static_cast<int>(widths[0])) << row[0] << std::right;
      for (std::size_t i = 1; i < last; i = i + 1 < kNames ? i + 1 : std::max(i + 1, first))
        out << "  " << std::setw(static_cast<int>(widths[i])) << row[i];
      out << '\n';
    }
  }
  const Json& reference = bench["reference"];
  out << "reference: " << formatted("%.6g", number(reference["samples"]))
      << " samples, its own error "
      << formatted("%.2g %%", 100 * number(reference["relative_error"]))
      << (reference["cached"].get<bool>()
              ? ", from the cache"
              : ", computed in " + seconds_text(number(reference["seconds"])))
      << '\n';
  for (const char* name : {"backward", "forward"})
    if (bench["fitted_slope"][name].is_number())
      out << "fitted slope, " << name << ": "
          << formatted("%.2f", number(bench["fitted_slope"][name])) << '\n';
  return out.str();
}

std::string bench_csv(const Json& bench) {
  std::ostringstream out;
  out << std::setprecision(17);
  bool first = true;
  for (const Json& point : bench["points"]) {
    if (first)
      for (auto it = point.begin(); it != point.end(); ++it)
        out << (it == point.begin() ? "" : ",") << it.key();
    if (first) out << '\n';
    first = false;
    for (auto it = point.begin(); it != point.end(); ++it) {
      if (it != point.begin()) out << ',';
      if (it->is_string())
        out << it->get<std::string>();
      else if (it->is_number())
        out << it->get<double>();
    }
    out << '\n';
  }
  return out.str();
}

void write_bench_plots(const std::string& base, const Json& bench) {
  Plot plot;
  plot.title = "Error against time: " +
               std::filesystem::path(bench["scene"].get<std::string>()).stem().string();
  plot.x_label = "wall time [s], " + std::to_string(bench["threads"].get<int>()) +
                 (bench["threads"] == 1 ? " thread" : " threads");
  plot.y_label = "relative RMSE over lit pixels [%]";
  plot.series = {{"backward", {}, {0.0, 0.35, 0.7}},
                 {"forward (the paper's method)", {}, {0.8, 0.3, 0.05}}};
  for (const Json& point : bench["points"]) {
    const double error = 100 * number(point["relative_rmse"]);
    if (!(error > 0)) continue;
    plot.series[point["estimator"] == "forward" ? 1 : 0].points.emplace_back(
        number(point["seconds"]), error);
  }
  for (const PlotSeries& series : plot.series) {
    if (series.points.empty()) continue;
    const auto& [x, y] = series.points.back();
    plot.guides = {{"slope -1/2", x, y, -0.5}, {"slope -1", x, y, -1}};
    break;
  }
  write_plot_svg(base + ".svg", {plot});
  write_plot_png(base + ".png", {plot});
}

Json read_bench_json(const std::string& path) {
  const Json json = Json::parse(read_file(path), nullptr, false);
  if (member(json, "kind") != "plenoflame bench" || !member(json, "points").is_array())
    throw InputError(path + " is not what 'plenoflame bench -o' writes");
  if (member(json, "format") != kFormat)
    throw InputError(path + " is of another format; run 'plenoflame bench' again to compare");
  const Json points = member(json, "points");
  for (std::size_t i = 0; i < points.size(); ++i)
    for (const char* key : {"samples", "seconds", "seconds_least", "seconds_most"})
      if (!member(points[i], key).is_number())
        throw InputError(path + " is damaged: \"points\" [" + std::to_string(i) + "] has no " +
                         key);
  return json;
}

std::string bench_comparison(const Json& now, const Json& old) {
  std::ostringstream out;
  const auto same = [&](const char* key) { return member(now, key) == member(old, key); };
  if (!same("scene_text") || !same("window"))
    out << "warning: scene or window differ from those of the old run; the ratios mean little\n";
  if (!same("machine") || !same("threads"))
    out << "warning: machine or threads differ from those of the old run; compare errors, not "
           "times\n";
  int common = 0;
  for (const Json& a : now["points"])
    for (const Json& b : old["points"]) {
      if (member(a, "estimator") != member(b, "estimator") || a["samples"] != b["samples"])
        continue;
      ++common;
      const auto ratio = [&](const char* key) {
        return number(member(a, key)) / number(member(b, key));
      };
      // Times count as different when all runs of one were faster than all of the other.
      const char* speed = number(a["seconds_most"]) < number(b["seconds_least"])   ? "faster"
                          : number(a["seconds_least"]) > number(b["seconds_most"]) ? "slower"
                                                                                   : "as fast";
      const double error = ratio("relative_rmse");
      // Errors of the errors: some per cent over a few hundred lit pixels or more.
      const char* accuracy = error < 0.9   ? "more accurate"
                             : error > 1.1 ? "less accurate"
                                           : "as accurate";
      out << a["estimator"].get<std::string>() << ' ' << formatted("%.6g", number(a["samples"]))
          << ": " << speed << ", " << accuracy << "; new/old: time "
          << formatted("%.3f", ratio("seconds")) << ", RMSE " << formatted("%.3f", error)
          << ", efficiency " << formatted("%.3f", ratio("efficiency")) << ", memory "
          << formatted("%.2f", ratio("peak_memory")) << '\n';
    }
  if (common == 0)
    throw InputError("the old run has no estimator and number of samples in common with this one");
  return out.str();
}

}  // namespace plenoflame::cli
