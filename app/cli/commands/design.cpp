#include "plenoflame/camera/design.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <iostream>
#include <memory>

#include "commands/commands.h"
#include "commands/scene_input.h"
#include "options.h"
#include "report.h"
#include "run.h"

namespace plenoflame::cli {
namespace {

struct Settings {
  std::string scene;
  bool json = false;
};

std::string mm(double value) {
  return std::isfinite(value) ? readable(value + 0.0, Dimension::length) : std::string("infinity");
}

/// Infinity stands for itself; past it there is nothing to see, but the range goes on.
std::string object_text(double value) {
  return value < 0 ? "past infinity" : mm(value);
}

nlohmann::json range_json(const SharpRange& range) {
  return {range.near, range.focus, range.far};
}

void add_lens(const CameraDesign& d, Report& report) {
  const FirstOrder& lens = d.lens;
  report.add("focal length", mm(lens.focal_length), "focal_length_m", lens.focal_length);
  report.add("back focal distance", mm(lens.back_focal_distance), "back_focal_distance_m",
             lens.back_focal_distance);
  report.add("entrance pupil",
             mm(lens.entrance_pupil_diameter) + " wide, " + mm(lens.entrance_pupil) +
                 " behind the first vertex",
             "entrance_pupil_m", {lens.entrance_pupil, lens.entrance_pupil_diameter});
  report.add(
      "exit pupil",
      mm(lens.exit_pupil_diameter) + " wide, " + mm(lens.exit_pupil) + " behind the last vertex",
      "exit_pupil_m", {lens.exit_pupil, lens.exit_pupil_diameter});
  report.add("in focus", "object at " + object_text(d.object_distance), "object_distance_m",
             d.object_distance);
  report.add("working f-number", readable_number(d.array_f_number), "f_number", d.array_f_number);
}

void add_types(const Camera& camera, const CameraDesign& d, Report& report) {
  const double pixel = camera.spec().sensor.pixel_pitch, pitch = camera.spec().array.pitch;
  nlohmann::json types = nlohmann::json::array();
  for (const TypeDesign& t : d.types) {
    const double overlap = (t.image_diameter - pitch) / pixel;
    report.add_text("type " + t.name, "focal length " + mm(t.focal_length) + ", B " +
                                          mm(t.sensor_distance) +
                                          (t.keplerian ? ", Keplerian" : ", Galilean"));
    report.add_text("  f-number", "B/D " + readable_number(t.f_number) + " against " +
                                      readable_number(d.array_f_number) + " of the main lens");
    report.add_text("  micro-image", readable_number(t.image_diameter / pixel) + " pixels wide, " +
                                         readable_number(std::fabs(overlap)) +
                                         (overlap > 0 ? " more" : " less") + " than the pitch");
    report.add_text("  sharp at the array", mm(t.array.near) + " to " + mm(t.array.far) +
                                                (t.array.far < 0 ? " (through infinity)" : "") +
                                                ", best " + mm(t.array.focus) +
                                                ", v = " + readable_number(t.virtual_depth));
    report.add_text("  sharp in the scene", object_text(t.object.near) + " to " +
                                                object_text(t.object.far) + ", best " +
                                                object_text(t.object.focus));
    types.push_back({{"name", t.name},
                     {"focal_length_m", t.focal_length},
                     {"sensor_distance_m", t.sensor_distance},
                     {"f_number", t.f_number},
                     {"image_diameter_m", t.image_diameter},
                     {"overlap_pixels", overlap},
                     {"keplerian", t.keplerian},
                     {"virtual_depth", t.virtual_depth},
                     {"dioptric_width_1_m", t.dioptric_width},
                     {"array_m", range_json(t.array)},
                     {"object_m", range_json(t.object)}});
  }
  if (d.types.empty()) return;
  report.add_json("types", types);
  report.add("all types together",
             readable_number(d.joint_ratio) + " times the depth of field of the first, in dioptres",
             "joint_ratio", d.joint_ratio);
  if (d.covering_depth > 0)
    report.add("total covering", "from |v| = " + readable_number(d.covering_depth) + " on",
               "covering_depth", d.covering_depth);
}

int run_design(const Settings& settings) {
  std::vector<std::string> warnings;
  const Scene scene = read_valid_scene(settings.scene, warnings).scene;
  const Camera camera(scene.camera, &warnings);
  const CameraDesign d = design(camera);
  warnings.insert(warnings.end(), d.warnings.begin(), d.warnings.end());
  for (const std::string& warning : warnings)
    std::cerr << "plenoflame: warning: " << warning << '\n';
  Report report;
  add_lens(d, report);
  add_types(camera, d, report);
  nlohmann::json spots = nlohmann::json::array();
  for (const SpotDesign& spot : d.spots) {
    report.add_text("spot at " + mm(spot.image_height),
                    "RMS radius " + mm(spot.rms) + ", best " + mm(std::fabs(spot.shift)) +
                        (spot.shift < 0 ? " behind" : " in front of") + " the paraxial image");
    spots.push_back(
        {{"image_height_m", spot.image_height}, {"rms_m", spot.rms}, {"shift_m", spot.shift}});
  }
  report.add_json("spots", spots);
  report.add_json("warnings", warnings);
  report.print(settings.json);
  return kSuccess;
}

}  // namespace

void register_design(const Registry& registry) {
  auto settings = std::make_shared<Settings>();
  CLI::App& command =
      add_command(registry, "design", "Work out what a camera can do: pupils, depth of field, blur",
                  "plenoflame design examples/paper-flame-1m.toml");
  command.add_option("SCENE", settings->scene, "Scene file (.toml)")->required();
  command.add_flag("--json", settings->json, "Print the figures as JSON");
  on_chosen(command, registry, [settings] { return run_design(*settings); });
}

}  // namespace plenoflame::cli
