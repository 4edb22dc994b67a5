#include "plenoflame/camera/design.h"
#include "choice.h"
#include "commands/add_option.h"
#include "number_range.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <memory>
#include <utility>

#include "camera_optimizer.h"
#include "commands/commands.h"
#include "commands/scene/design_array.h"
#include "commands/scene/design_filters.h"
#include "commands/scene/lens_report.h"
#include "commands/scene_input.h"
#include "messages.h"
#include "options.h"
#include "outputs.h"
#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/scene/cameras.h"
#include "plenoflame/scene/design_report.h"
#include "plenoflame/scene/lens_file.h"
#include "run.h"
#include "terminal.h"

namespace plenoflame::cli {
namespace {

struct DesignArguments {
  std::string scene, camera;
  std::vector<std::string> set;
  bool json = false;
  std::string plots;
  std::string format = "png";
  ArrayTask array;
  LensTask lens;
};

/// Writes plots into the requested folder.
class PlotFolder {
 public:
  explicit PlotFolder(const DesignArguments& settings)
      : folder_(settings.plots), format_(settings.format) {
    std::error_code error;
    std::filesystem::create_directories(folder_, error);
    if (error) throw FileError(settings.plots + ": " + error.message());
  }
  void write(const std::string& name, const std::vector<Plot>& plots, int columns) const {
    if (!plots.empty()) write_plot((folder_ / (name + "." + format_)).string(), plots, columns);
  }

 private:
  std::filesystem::path folder_;
  std::string format_;
};

void warn_of(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) warn(warning);
}

int run_lens(const DesignArguments& settings) {
  if (!settings.array.freedom.empty())
    throw UsageError("--solve: a lens alone has no array; give a scene");
  if (!settings.set.empty())
    throw UsageError("--set: " + settings.scene + " is a lens alone; give a scene");
  Report report;
  LensTask task = settings.lens;
  task.file = settings.scene;
  MainLensSpec lens;
  std::vector<std::string> notes;
  const LensDesign d = add_lens_design(task, lens, notes, report);
  warn_of(notes);
  report.add_json("warnings", notes);
  if (!settings.array.output.empty()) {
    write_file(settings.array.output, write_lens(lens));
  }
  if (!settings.plots.empty()) {
    const PlotFolder folder(settings);
    folder.write("lens-spots", spot_diagrams(d), 3);
    folder.write("lens-fans", ray_fans(d), 3);
    folder.write("lens-fields", field_plots(d), 3);
  }
  print(report, settings.json);
  return kSuccess;
}

/// Effective resolution against the object's distance: paraxial dashed, by rays solid.
Plot resolution_plot(const std::vector<ResolutionPoint>& curve, const CameraDesign& d) {
  Plot plot;
  plot.title = "Effective resolution: by rays (solid), paraxial (dashed)";
  plot.x_label = "object distance from the front vertex [m]";
  plot.y_label = "pixels kept along one axis";
  plot.log_x = plot.log_y = false;
  for (std::size_t k = 0; k < d.types.size(); ++k) {
    PlotSeries paraxial{"", {}, plot_colour(k), PlotStyle::dashed};
    PlotSeries traced{d.types[k].name, {}, plot_colour(k), PlotStyle::line};
    for (const ResolutionPoint& p : curve) {
      paraxial.points.emplace_back(p.object_distance, p.paraxial[k]);
      traced.points.emplace_back(p.object_distance, p.traced[k]);
    }
    plot.series.push_back(std::move(paraxial));
    plot.series.push_back(std::move(traced));
  }
  return plot;
}

/// RMS radius of the spot of the main lens over the field, and over the object's distance around
/// the plane in focus. Empty for an ideal lens.
std::vector<Plot> spot_plots(const Camera& camera, const CameraDesign& d) {
  if (camera.ideal_lens()) return {};
  constexpr int kPoints = 21, kRings = 200;
  const SensorSpec& sensor = camera.spec().sensor;
  const double corner = sensor.corner();
  const auto& surfaces = camera.spec().lens.surfaces;
  Plot field, distance;
  field.title = "Spot of the main lens over the field, in its best plane";
  field.x_label = "paraxial image height [mm]";
  distance.title = "Spot of the main lens on the axis, in its best plane";
  distance.x_label = "object distance from the front vertex [m]";
  field.y_label = distance.y_label = "RMS radius [mm]";
  field.log_x = field.log_y = distance.log_y = false;
  PlotSeries over_field{"", {}, plot_colour(0)}, over_distance = over_field;
  const double nearest = -1.1 * d.lens.front_focal_distance;
  for (int i = 0; i < kPoints; ++i) {
    const double height = corner * i / (kPoints - 1);
    const double from =
        std::isfinite(d.object_distance) ? std::max(nearest, 0.3 * d.object_distance) : nearest;
    const double to = std::isfinite(d.object_distance) ? 10 * d.object_distance : 100 * nearest;
    const double object = from * std::pow(to / from, double(i) / (kPoints - 1));
    try {
      over_field.points.emplace_back(
          1e3 * height, 1e3 * best_spot(surfaces, d.object_distance, height, kRings).rms);
    } catch (const InputError&) {
    }  // vignetted: no point
    try {
      over_distance.points.emplace_back(object, 1e3 * best_spot(surfaces, object, 0, kRings).rms);
    } catch (const InputError&) {
    }
  }
  field.series = {over_field};
  distance.series = {over_distance};
  return {field, distance};
}

void write_plots(const DesignArguments& settings, const Camera& camera, const CameraDesign& d,
                 const std::vector<ResolutionPoint>& curve, const std::vector<SolvedType>& solved) {
  const PlotFolder folder(settings);
  if (!curve.empty()) folder.write("resolution", {resolution_plot(curve, d)}, 1);
  folder.write("spots", spot_plots(camera, d), 2);
  const ArraySpec& array = camera.spec().array;
  const bool has_faces = array.present && !(std::isinf(array.types.front().radius_front) &&
                                            std::isinf(array.types.front().radius_back));
  if (has_faces)
    folder.write("microlens", microlens_plots(array, solved, settings.array.freedom), 3);
}

int run_design(const DesignArguments& settings) {
  if (is_bare_lens(settings.scene)) return run_lens(settings);
  const ArrayTask& task = settings.array;
  if (!task.output.empty() && task.freedom.empty())
    throw UsageError("--output: there is nothing to write without --solve");
  const LensTask& lens = settings.lens;
  for (const auto& [option, given] : {std::pair{"--field", !lens.field.empty()},
                                      {"--distance", !lens.distance.empty()},
                                      {"--wavelength", !lens.wavelength.empty()},
                                      {"--paraxial-focus", lens.paraxial_focus}})
    if (given)
      throw UsageError(
          std::string(option) +
          " applies only to a lens alone; the lens of a scene has its sensor, focus and channels");
  std::vector<std::string> warnings;
  const Scene whole = read_valid_scene(settings.scene, settings.set, &warnings).scene;
  const Scene scene = choose_camera({whole, {}}, settings.camera).scene;
  const Camera camera(scene.camera);
  const CameraDesign d = design(camera);
  for (std::size_t i = 0; i < d.types.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (std::fabs(d.types[i].focal_length / d.types[k].focal_length - 1) < 1e-9)
        throw InputError(settings.scene + ": the microlens types \"" + d.types[k].name +
                         "\" and \"" + d.types[i].name + "\" have the same focal length, " +
                         length_text(d.types[i].focal_length) +
                         ": give them different ones, or leave one out");
  warnings.insert(warnings.end(), d.warnings.begin(), d.warnings.end());
  warn_of(warnings);
  const auto curve = design_curve(camera, scene);
  Report report;
  if (!scene.camera.name.empty())
    report.add("camera", scene.camera.name, "camera", scene.camera.name);
  add_design(camera, d, curve, report);
  add_pupil_filters(camera, d, report);
  if (!scene.windows.empty()) add_windows(camera, scene.windows, report);
  report.add_json("warnings", warnings);
  std::vector<SolvedType> solved;
  if (!task.freedom.empty()) solved = solve_for_array(task, scene, report);
  if (!task.output.empty()) {
    const Scene changed = with_solved_array(scene, solved, freedom_named(task.freedom));
    write_scene_file(task.output, replace_camera(whole, changed.camera));
  }
  if (!settings.plots.empty()) write_plots(settings, camera, d, curve, solved);
  print(report, settings.json);
  return kSuccess;
}

}  // namespace

void register_design(const Registry& registry) {
  auto settings = std::make_shared<DesignArguments>();
  CLI::App& command =
      add_command(registry, "design", "Compute what a camera can do: pupils, depth of field, blur",
                  "plenoflame design examples/paper-flame-1m.toml --plots out");
  command
      .add_option(
          "SCENE", settings->scene,
          "Scene file (.toml); or a lens alone: TOML with only [camera.lens], .zmx, .dat, .txt")
      ->required();
  add_set_option(command, settings->set);
  add_camera_option(command, settings->camera);
  command.add_flag("--json", settings->json, "Print the figures as JSON");
  add_option(command, "--plots", settings->plots, "DIR",
             "Folder for plots: effective resolution, spots, microlenses; of a lens: spots, ray "
             "fans, field curvature, distortion, vignetting")
      ->check(written());
  add_option(command, "--format", settings->format, "png|svg", "Format of the plots")
      ->check(one_of({"png", "svg"}))
      ->capture_default_str();
  add_option(
      command, "--solve", settings->array.freedom, "index|radius|thickness",
      "Find more microlens types that continue the depth of field of the first, by this quantity")
      ->check(one_of({"index", "radius", "thickness"}));
  add_option(command, "--types", settings->array.types, "N", "With --solve: number of types")
      ->check(CLI::Range(1, 3))
      ->capture_default_str();
  add_option(command, "--greatest-index", settings->array.index_limit, "INDEX",
             "With --solve: greatest refractive index of a type")
      ->check(number_between(1.0, 5.0))
      ->capture_default_str();
  const auto text_option = [&](const char* name, std::string& value, const char* shown,
                               const char* meaning) {
    return add_option(command, name, value, shown, meaning);
  };
  text_option("--least-radius", settings->array.least_radius, "LENGTH",
              "With --solve: smallest radius of the faces");
  text_option("--greatest-thickness", settings->array.greatest_thickness, "LENGTH",
              "With --solve: greatest thickness of a microlens");
  text_option("-o,--output", settings->array.output, "FILE.toml",
              "Scene with the types of --solve, or the prescription of a lens (.toml)")
      ->check(written({".toml"}));
  text_option("--field", settings->lens.field, "ANGLE",
              "Of a lens: greatest field angle; without it, where a tenth of the light passes, at "
              "most 45 deg");
  text_option("--distance", settings->lens.distance, "LENGTH",
              "Of a lens: object distance from the first vertex (infinite)");
  text_option("--wavelength", settings->lens.wavelength, "LENGTH",
              "Of a lens: vacuum wavelength (587.6 nm)");
  command.add_flag("--paraxial-focus", settings->lens.paraxial_focus,
                   "Of a lens: image plane at the paraxial focus, not at the smallest spot");
  on_chosen(command, registry, [settings] { return run_design(*settings); });
}

}  // namespace plenoflame::cli
