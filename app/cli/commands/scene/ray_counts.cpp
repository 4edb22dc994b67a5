#include "commands/scene/ray_counts.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

#include "options.h"
#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/optics/ray_status.h"

namespace plenoflame::cli {
namespace {

/// Number of the status with this name of to_string(). 4: unknown name.
std::size_t status_of(std::string_view name) {
  std::size_t k = 0;
  while (k < 4 && name != to_string(static_cast<RayStatus>(k))) ++k;
  return k;
}

/// Cells of a line; those in quotes may hold commas, and quotes twice.
std::vector<std::string> cells_of(std::string_view line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"')
      cells.back() += line[++i];
    else if (c == '"')
      quoted = !quoted;
    else if (c == ',' && !quoted)
      cells.emplace_back();
    else if (c != '\r')
      cells.back() += c;
  }
  return cells;
}

constexpr std::string_view kRadiance = "radiance.";

}  // namespace

void report_ray_counts(const RayCounts& counts, Report& report) {
  const auto add = [&](const char* label, std::size_t count, const char* key) {
    report.add(label, std::to_string(count), key, count);
  };
  add("rays", counts.rays, "rays");
  add("reached the scene", counts.by_status[0], "reached");
  add("vignetted", counts.by_status[1], "vignetted");
  add("totally reflected", counts.by_status[2], "total_internal_reflection");
  add("missed a surface", counts.by_status[3], "missed");
  add("vertices", counts.vertices, "vertices");
  add("with a share of a pixel", counts.of_images, "of_images");
  for (std::size_t c = 0; c < counts.channels.size(); ++c)
    report.add("flux, " + counts.channels[c],
               counts.of_images == 0
                   ? "none: without a share of a pixel they have radiance only"
                   : readable(counts.flux[c], Dimension::flux) + " carried by these rays",
               "flux." + counts.channels[c], counts.flux[c]);
}

RayCounts count_rays_of_csv(const std::string& path) {
  const std::string text = read_file(path);
  std::string_view rest = text;
  const auto next_line = [&] {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    return line;
  };
  const std::vector<std::string> names = cells_of(next_line());
  const auto column_of = [&](const std::string& name) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end())
      throw InputError(SourcePosition{path, 1},
                       "there is no column '" + name + "': this is not a file of ray paths (.csv)");
    return static_cast<std::size_t>(found - names.begin());
  };
  const std::size_t ray = column_of("ray"), status = column_of("status"),
                    weight = column_of("weight");
  RayCounts counts;
  std::vector<std::size_t> radiance;
  for (std::size_t k = 0; k < names.size(); ++k)
    if (names[k].starts_with(kRadiance)) {
      radiance.push_back(k);
      counts.channels.push_back(names[k].substr(kRadiance.size()));
    }
  counts.flux.resize(radiance.size());
  std::string last;
  for (int number = 2; !rest.empty(); ++number) {
    const std::string_view line = next_line();
    // The other vertices of a ray repeat what is said of it.
    if (counts.rays > 0 && ray == 0 && line.starts_with(last + ",") &&
        std::count(line.begin(), line.end(), ',') + 1 == std::ssize(names)) {
      ++counts.vertices;
      continue;
    }
    const std::vector<std::string> cells = cells_of(line);
    const auto refuse = [&](const std::string& what) {
      throw InputError(SourcePosition{path, number}, what);
    };
    if (cells.size() != names.size())
      refuse("there are " + std::to_string(cells.size()) + " cells, the header has " +
             std::to_string(names.size()));
    ++counts.vertices;
    if (counts.rays > 0 && cells[ray] == last) continue;
    last = cells[ray];
    ++counts.rays;
    const auto value = [&](std::size_t k) {
      double number_read = 0;
      const char* const end = cells[k].data() + cells[k].size();
      const auto [stop, error] = std::from_chars(cells[k].data(), end, number_read);
      if (error != std::errc{} || stop != end) refuse("'" + cells[k] + "' is not a number");
      return number_read;
    };
    const std::size_t how = status_of(cells[status]);
    if (how > 3) refuse("'" + cells[status] + "' is not the status of a ray");
    ++counts.by_status[how];
    counts.of_images += value(weight) > 0;
    for (std::size_t c = 0; c < radiance.size(); ++c)
      counts.flux[c] += value(weight) * value(radiance[c]);
  }
  return counts;
}

RayCounts count_rays_of_json(const std::string& path) {
  using Json = nlohmann::json;
  const std::string text = read_file(path);
  RayCounts counts;
  const auto refuse = [&](const std::string& what) { throw InputError("'" + path + "': " + what); };
  const auto add = [&](const Json& ray) {
    const std::size_t how = status_of(ray.at("status").get<std::string>());
    if (how > 3) refuse("ray " + std::to_string(counts.rays) + " has an unknown status");
    ++counts.rays;
    ++counts.by_status[how];
    counts.vertices += ray.at("vertices").size();
    counts.of_images += ray.at("weight").get<double>() > 0;
    const Json& radiance = ray.at("radiance");
    counts.flux.resize(std::max(counts.flux.size(), radiance.size()));
    for (std::size_t c = 0; c < radiance.size(); ++c)
      if (radiance[c].is_number())
        counts.flux[c] += ray.at("weight").get<double>() * radiance[c].get<double>();
  };
  // Rays are counted and released one by one: together they would take many times the file's size.
  bool rays = false;
  const auto event = [&](int depth, Json::parse_event_t what, Json& parsed) {
    if (depth == 1 && what == Json::parse_event_t::key) rays = parsed == "rays";
    if (!rays || depth != 2 || what != Json::parse_event_t::object_end) return true;
    add(parsed);
    return false;
  };
  try {
    const Json file = Json::parse(text, event);
    if (!file.is_object() || !file.contains("rays") || !file.contains("surfaces"))
      refuse("it has no \"rays\" and \"surfaces\": this is not a file of ray paths (.json)");
    counts.channels = file.at("channels").get<std::vector<std::string>>();
  } catch (const Json::exception& error) {
    const std::string message = error.what();
    refuse("this is not a file of ray paths (.json): " + message.substr(message.find("] ") + 2));
  }
  counts.flux.resize(counts.channels.size());
  return counts;
}

}  // namespace plenoflame::cli
