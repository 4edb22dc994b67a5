#include "commands/scene/design_filters.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "options.h"
#include "plenoflame/base/constants.h"
#include "plenoflame/lightfield/pupil_views.h"
#include "plenoflame/lightfield/views.h"
#include "plenoflame/radiometry/filter_points.h"

namespace plenoflame::cli {
namespace {

constexpr int kGrid = 7;

/// The wavelengths at which a transmission curve lets light through.
std::string band_text(const std::string& transmission) {
  if (transmission.empty()) return "all wavelengths";
  const std::vector<SpectralPoint> points = parse_filter_points(transmission);
  if (is_opaque(points)) return "opaque";
  const SpectralResponse curve = SpectralResponse::curve(points);
  return readable(curve.shortest(), Dimension::length) + " to " +
         readable(curve.longest(), Dimension::length) + ", centroid " +
         readable(curve.centroid(), Dimension::length);
}

/// A letter for each part of the stop.
char letter_of(const PupilFilters& filters, int part) {
  if (part < 0) return '.';
  return part < static_cast<int>(filters.filters().size()) ? static_cast<char>('a' + part) : '-';
}

}  // namespace

void add_pupil_filters(const Camera& camera, const CameraDesign& design, Report& report) {
  const PupilFilters& filters = camera.pupil_filters();
  if (filters.empty()) return;
  const std::vector<double> areas = filters.areas();
  const double pixel = camera.spec().sensor.pixel_pitch;
  // The etendue of a pixel on the axis: its area times the projected solid angle of the exit pupil.
  const double etendue =
      pixel * pixel * constants::pi / (4 * design.array_f_number * design.array_f_number + 1);
  nlohmann::json list = nlohmann::json::array();
  for (int part = 0; part < filters.parts(); ++part) {
    const auto i = static_cast<std::size_t>(part);
    const bool open = i == filters.filters().size();
    if (open && areas[i] < 1e-3) continue;
    const std::string band = open ? "no filter" : band_text(filters.filters()[i].transmission);
    report.add_text(std::string("part ") + letter_of(filters, part) + " of the stop",
                    filters.name(part) + ": " + readable_percent(areas[i]) + " of its area, " +
                        readable_number(areas[i] * etendue) + " m^2 sr of a pixel on the axis, " +
                        band);
    list.push_back(
        {{"name", filters.name(part)}, {"share", areas[i]}, {"etendue_m2_sr", areas[i] * etendue}});
  }
  report.add_json("pupil_parts", list);
  if (!camera.has_array()) return;
  const MicroImages micro(camera, false);
  const std::vector<int> parts = parts_of_views(micro, kGrid, ViewSettings{}.spread);
  nlohmann::json seen = nlohmann::json::array();
  for (int row = 0; row < kGrid; ++row) {
    std::string line;
    nlohmann::json names = nlohmann::json::array();
    for (int column = 0; column < kGrid; ++column) {
      const int part = parts[static_cast<std::size_t>(row * kGrid + column)];
      line += std::string(column > 0 ? " " : "") + letter_of(filters, part);
      names.push_back(part < 0 ? nlohmann::json() : nlohmann::json(filters.name(part)));
    }
    report.add_text(row == 0 ? "views see" : "", line);
    seen.push_back(names);
  }
  report.add_json("views_see", seen);
  double blur = 0;
  for (int type = 0; type < static_cast<int>(camera.microlenses().size()); ++type)
    blur = std::max(blur, blur_of_stop(micro, type));
  report.add("blur of the stop",
             readable_number(blur) + " of its radius within a pixel, by its microlens", "stop_blur",
             blur);
}

}  // namespace plenoflame::cli
