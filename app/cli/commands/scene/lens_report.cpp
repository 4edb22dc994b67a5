#include "commands/scene/lens_report.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "options.h"
#include "plenoflame/base/constants.h"
#include "plenoflame/base/error.h"
#include "plenoflame/optics/glass.h"
#include "plenoflame/scene/design_report.h"
#include "plenoflame/scene/glass_indices.h"
#include "plenoflame/scene/lens_file.h"
#include "plenoflame/scene/scene_file.h"

namespace plenoflame::cli {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;
constexpr int kFields = 11;

std::string degrees(double angle) {
  return readable_number(angle / kDegree) + " deg";
}

/// The fields that diagrams show: axis, 0.7 of the field, full field.
std::vector<const LensFieldDesign*> three_fields(const LensDesign& d) {
  const std::size_t last = d.fields.size() - 1;
  return {&d.fields[0], &d.fields[last * 7 / 10], &d.fields[last]};
}

}  // namespace

bool is_bare_lens(const std::string& path) {
  const auto ends = [&](const char* ending) { return path.ends_with(ending); };
  if (ends(".zmx") || ends(".ZMX") || ends(".dat") || ends(".txt")) return true;
  if (!ends(".toml")) return false;
  const Scene scene = read_scene_file(path).scene;
  return scene.cameras.empty() && scene.camera.sensor.columns == 0 && !scene.camera.array.present;
}

LensDesign add_lens_design(const LensTask& task, MainLensSpec& lens,
                           std::vector<std::string>& notes, Report& report) {
  LensFile file = read_lens_file(task.file);
  notes.insert(notes.end(), file.notes.begin(), file.notes.end());
  double wavelength = kLineD;
  if (!task.wavelength.empty())
    wavelength = quantity_option("--wavelength", task.wavelength, Dimension::length);
  if (!(wavelength >= 100e-9 && wavelength <= 100e-6))
    throw UsageError("--wavelength: " + task.wavelength + " is not from 100 nm to 100 um");
  CameraSpec camera;
  camera.lens = file.lens;
  set_indices(camera, wavelength);
  lens = file.lens;
  const double field =
      task.field.empty() ? 0 : quantity_option("--field", task.field, Dimension::angle);
  if (!task.field.empty() && !(field > 0 && field < 0.5 * constants::pi))
    throw UsageError("--field: " + task.field + " is not an angle above 0 and below 90 deg");
  const double distance = task.distance.empty()
                              ? kInfinity
                              : quantity_option("--distance", task.distance, Dimension::length);
  const double focus = task.paraxial_focus ? 0 : std::numeric_limits<double>::quiet_NaN();
  const LensDesign d = design_lens(camera.lens.surfaces, distance, field, kFields, focus);
  if (!file.title.empty()) report.add("lens", file.title, "title", file.title);
  report.add("wavelength", length_text(wavelength), "wavelength_m", wavelength);
  report.add("focal length", length_text(d.lens.focal_length), "focal_length_m",
             d.lens.focal_length);
  report.add("back focal distance", length_text(d.lens.back_focal_distance),
             "back_focal_distance_m", d.lens.back_focal_distance);
  report.add("entrance pupil",
             length_text(d.lens.entrance_pupil_diameter) + " wide, " +
                 length_text(d.lens.entrance_pupil) + " behind the first vertex",
             "entrance_pupil_m", {d.lens.entrance_pupil, d.lens.entrance_pupil_diameter});
  report.add("exit pupil",
             length_text(d.lens.exit_pupil_diameter) + " wide, " + length_text(d.lens.exit_pupil) +
                 " behind the last vertex",
             "exit_pupil_m", {d.lens.exit_pupil, d.lens.exit_pupil_diameter});
  const double number = d.lens.focal_length / d.lens.entrance_pupil_diameter;
  report.add("f-number", readable_number(number), "f_number", number);
  report.add("image plane",
             length_text(d.image_distance) + " behind the last vertex, " +
                 length_text(std::fabs(d.focus)) + (d.focus < 0 ? " before" : " behind") +
                 " the paraxial image",
             "image_distance_m", d.image_distance);
  report.add_json("focus_shift_m", d.focus);
  const bool vignetted = field == 0 && d.fields.back().throughput < 0.2;
  report.add(
      "field",
      "to " + degrees(d.greatest_field) + (vignetted ? ", where a tenth of the light is left" : ""),
      "greatest_field_rad", d.greatest_field);
  nlohmann::json fields = nlohmann::json::array();
  for (const LensFieldDesign& f : d.fields) {
    nlohmann::json tangential = nlohmann::json::array(), sagittal = tangential;
    for (const FanPoint& p : f.tangential_fan) tangential.push_back({p.pupil, p.error});
    for (const FanPoint& p : f.sagittal_fan) sagittal.push_back({p.pupil, p.error});
    fields.push_back({{"field_rad", f.field},
                      {"image_height_m", f.image_height},
                      {"distortion", f.distortion},
                      {"throughput", f.throughput},
                      {"tangential_focus_m", f.tangential},
                      {"sagittal_focus_m", f.sagittal},
                      {"rms_m", f.rms},
                      {"tangential_fan_m", tangential},
                      {"sagittal_fan_m", sagittal}});
  }
  for (const LensFieldDesign* f : three_fields(d))
    report.add_text("at " + degrees(f->field),
                    "RMS radius " + length_text(f->rms) + ", distortion " +
                        readable_percent(f->distortion) + ", " + readable_percent(f->throughput) +
                        " of the light, focus T " + length_text(f->tangential) + ", S " +
                        length_text(f->sagittal));
  report.add_json("fields", fields);
  return d;
}

std::vector<Plot> spot_diagrams(const LensDesign& d) {
  std::vector<Plot> plots;
  for (const LensFieldDesign* f : three_fields(d)) {
    Plot plot;
    plot.title = "Spot at " + degrees(f->field) + ", RMS radius " + length_text(f->rms);
    plot.x_label = "away from the axis [um]";
    plot.y_label = "across [um]";
    plot.log_x = plot.log_y = false;
    plot.equal_scales = true;
    PlotSeries series{"", {}, plot_colour(1), PlotStyle::marks};
    for (const Vec2 at : f->spot) series.points.emplace_back(1e6 * at.x, 1e6 * at.y);
    plot.series = {series};
    plots.push_back(std::move(plot));
  }
  return plots;
}

std::vector<Plot> ray_fans(const LensDesign& d) {
  std::vector<Plot> plots;
  for (const LensFieldDesign* f : three_fields(d)) {
    Plot plot;
    plot.title = "Ray fans at " + degrees(f->field);
    plot.x_label = "place in the entrance pupil";
    plot.y_label = "transverse aberration [um]";
    plot.log_x = plot.log_y = false;
    PlotSeries tangential{"tangential", {}, plot_colour(0), PlotStyle::line};
    PlotSeries sagittal{"sagittal", {}, plot_colour(1), PlotStyle::dashed};
    for (const FanPoint& p : f->tangential_fan)
      tangential.points.emplace_back(p.pupil, 1e6 * p.error);
    for (const FanPoint& p : f->sagittal_fan) sagittal.points.emplace_back(p.pupil, 1e6 * p.error);
    plot.series = {tangential, sagittal};
    plots.push_back(std::move(plot));
  }
  return plots;
}

std::vector<Plot> field_plots(const LensDesign& d) {
  Plot curvature, distortion, vignetting;
  curvature.title = "Field curvature";
  curvature.y_label = "focus from the image plane [mm]";
  distortion.title = "Distortion";
  distortion.y_label = "distortion [%]";
  vignetting.title = "Vignetting";
  vignetting.y_label = "light, of that on the axis [%]";
  PlotSeries tangential{"tangential", {}, plot_colour(0), PlotStyle::line};
  PlotSeries sagittal{"sagittal", {}, plot_colour(1), PlotStyle::dashed};
  PlotSeries bend{"", {}, plot_colour(1), PlotStyle::line}, light = bend;
  for (const LensFieldDesign& f : d.fields) {
    const double angle = f.field / kDegree;
    tangential.points.emplace_back(angle, 1e3 * f.tangential);
    sagittal.points.emplace_back(angle, 1e3 * f.sagittal);
    bend.points.emplace_back(angle, 100 * f.distortion);
    light.points.emplace_back(angle, 100 * f.throughput);
  }
  curvature.series = {tangential, sagittal};
  distortion.series = {bend};
  vignetting.series = {light};
  std::vector<Plot> plots{curvature, distortion, vignetting};
  for (Plot& plot : plots) {
    plot.x_label = "field angle [deg]";
    plot.log_x = plot.log_y = false;
  }
  return plots;
}

}  // namespace plenoflame::cli
