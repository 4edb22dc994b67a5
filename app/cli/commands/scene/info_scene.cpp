#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "commands/scene/info.h"
#include "commands/scene_input.h"
#include "messages.h"
#include "options.h"
#include "plenoflame/camera/microlens_lattice.h"
#include "plenoflame/scene/cameras.h"
#include "plenoflame/scene/channel_kinds.h"
#include "plenoflame/scene/scene_file.h"
#include "plenoflame/scene/scene_schema.h"
#include "plenoflame/scene/spectral.h"
#include "plenoflame/scene/timeline.h"

namespace plenoflame::cli {
namespace {

std::string lens_text(const MainLensSpec& lens) {
  const std::string model = lens.model == LensModel::ideal ? "ideal" : "real";
  if (lens.surfaces.empty())
    return model + ", focal length " + readable(lens.focal_length, Dimension::length) +
           ", diameter " + readable(lens.diameter, Dimension::length);
  return model + ", " + std::to_string(lens.surfaces.size()) + " surfaces";
}

std::string array_text(const ArraySpec& array) {
  if (!array.present) return "none: a conventional camera";
  std::string shape;
  if (array.aperture == ApertureShape::square)
    shape = array.diameter_y > 0 && array.diameter_y != array.diameter ? "rectangular lenses, "
                                                                       : "square lenses, ";
  if (array.aperture == ApertureShape::hexagonal) shape = "hexagonal lenses, ";
  std::string count;
  if (array.columns > 0 || array.rows > 0) {
    const auto number = [](int n) { return n > 0 ? std::to_string(n) : std::string("endless"); };
    count = number(array.columns) + " x " + number(array.rows) + " of them, ";
  }
  return std::string(array.lattice == Lattice::hexagonal ? "hexagonal" : "square") + ", pitch " +
         readable(array.pitch, Dimension::length) +
         (is_regular(array) ? "" : " by " + readable(array.pitch_y, Dimension::length)) + ", " +
         shape + count + std::to_string(array.types.size()) +
         (array.types.size() == 1 ? " type" : " types") + ", " +
         readable(array.sensor_distance, Dimension::length) + " in front of the sensor";
}

std::string focus_text(const FocusSpec& focus) {
  if (focus.mode == FocusMode::distance)
    return "lens at " + readable(focus.lens_distance, Dimension::length);
  return std::string(focus.mode == FocusMode::best ? "best" : "paraxial") + ", object at " +
         readable(focus.object_distance, Dimension::length) + " sharp on " + focus.conjugate;
}

/// "650nm, 850nm", those without a name by their numbers.
std::string filters_text(const std::vector<PupilFilterSpec>& filters) {
  std::string text;
  for (std::size_t i = 0; i < filters.size(); ++i)
    text += (i > 0 ? ", " : "") + (filters[i].name.empty() ? std::to_string(i) : filters[i].name);
  return text;
}

std::string sensor_text(const SensorSpec& sensor) {
  return std::to_string(sensor.columns) + " x " + std::to_string(sensor.rows) + " pixels of " +
         readable(sensor.pixel().x, Dimension::length) +
         (sensor.square_pixels() ? "" : " by " + readable(sensor.pixel().y, Dimension::length));
}

/// The only camera of a scene.
void add_camera(const CameraSpec& camera, Report& report) {
  if (!camera.name.empty()) report.add("camera", camera.name, "camera", camera.name);
  const SensorSpec& sensor = camera.sensor;
  report.add("sensor", sensor_text(sensor), "sensor", {sensor.columns, sensor.rows});
  report.add_json("pixel_pitch_m", sensor.pixel_pitch);
  report.add("main lens", lens_text(camera.lens), "main_lens", lens_text(camera.lens));
  report.add("microlens array", array_text(camera.array), "microlens_array",
             array_text(camera.array));
  report.add("focus", focus_text(camera.focus), "focus", focus_text(camera.focus));
  if (!camera.pupil_filters.empty())
    report.add("pupil filters", filters_text(camera.pupil_filters), "pupil_filters",
               filters_text(camera.pupil_filters));
}

nlohmann::json camera_json(const CameraSpec& camera) {
  const Vec3 p = camera.position;
  return {{"name", camera.name},
          {"position_m", {p.x, p.y, p.z}},
          {"sensor", {camera.sensor.columns, camera.sensor.rows}},
          {"pixel_pitch_m", camera.sensor.pixel_pitch},
          {"main_lens", lens_text(camera.lens)},
          {"microlens_array", array_text(camera.array)},
          {"focus", focus_text(camera.focus)},
          {"pupil_filters", filters_text(camera.pupil_filters)}};
}

std::string flame_text(const FlameSpec& flame) {
  std::string text = flame.kind == FlameKind::vdb ? "grids of '" + flame.file + "'"
                                                  : std::to_string(flame.layers.size()) + " layers";
  return text + " at " + readable_point(flame.position);
}

/// "tube, radius 15 mm, wall 2 mm, height 80 mm, of FUSED-SILICA, at 0.75 m, 0 m, -0.04 m".
std::string window_text(const WindowSpec& window, const std::string& shape) {
  const auto length = [](double value) { return readable(value, Dimension::length); };
  const bool flat = window.shape == WindowShape::plate || window.shape == WindowShape::wedge;
  std::string text = shape;
  if (!flat)
    text += ", radius " + length(window.radius) + ", wall " + length(window.thickness) +
            ", height " + length(window.height);
  else
    text +=
        (window.diameter > 0 ? ", diameter " + length(window.diameter)
                             : ", " + length(window.extent.x) + " by " + length(window.extent.y)) +
        ", " + length(window.thickness) + " thick";
  text +=
      window.glass.empty() ? ", of index " + readable_number(window.index) : ", of " + window.glass;
  return text + ", at " + readable_point(window.position);
}

void add_windows(const Scene& scene, Report& report) {
  nlohmann::json list = nlohmann::json::array();
  for (std::size_t i = 0; i < scene.windows.size(); ++i) {
    const WindowSpec& window = scene.windows[i];
    const std::string shape = get_text(scene, "windows[" + std::to_string(i) + "].shape");
    const std::string name = window.name.empty() ? std::to_string(i + 1) : window.name;
    report.add_text("window " + name, window_text(window, shape));
    const Vec3 p = window.position;
    list.push_back({{"name", window.name}, {"shape", shape}, {"position_m", {p.x, p.y, p.z}}});
  }
  report.add_json("windows", list);
}

/// An emission line, and what each channel sees of it; filters of cameras are a camera's own.
std::string line_text(const Scene& scene, const LineSpec& spec) {
  const EmissionLine line = emission_line(spec);
  std::string text = readable(line.wavelength(), Dimension::length);
  if (line.width() > 0) text += ", " + readable(line.width(), Dimension::length) + " wide";
  for (const ChannelSpec& channel : scene.channels)
    text += ", " + channel.name + " sees " +
            readable_number(line.seen_by(camera_response(scene, channel)));
  return text;
}

nlohmann::json lines_json(const Scene& scene, const FlameSpec& flame, const std::string& path) {
  nlohmann::json lines = nlohmann::json::array();
  for (std::size_t l = 0; l < flame.lines.size(); ++l) {
    const EmissionLine line = emission_line(flame.lines[l]);
    nlohmann::json seen = nlohmann::json::object();
    for (const ChannelSpec& channel : scene.channels)
      seen[channel.name] = line.seen_by(camera_response(scene, channel));
    lines.push_back({{"kind", get_text(scene, path + ".lines[" + std::to_string(l) + "].kind")},
                     {"wavelength_m", line.wavelength()},
                     {"width_m", line.width()},
                     {"grid", flame.lines[l].emission.grid},
                     {"seen", seen}});
  }
  return lines;
}

std::string numbers_text(const std::vector<int>& numbers) {
  constexpr std::size_t kMostNamed = 6;
  std::string text;
  for (std::size_t i = 0; i < numbers.size() && i < kMostNamed; ++i)
    text += (i == 0 ? "" : ", ") + std::to_string(numbers[i]);
  if (numbers.size() > kMostNamed)
    text += " and " + std::to_string(numbers.size() - kMostNamed) + " more";
  return text;
}

/// Reports how the flames change with time, and which frames there are.
void add_time(const SceneDocument& document, Report& report) {
  if (!changes_with_time(document.scene)) return;
  nlohmann::json list = nlohmann::json::array();
  const SceneTimeline timeline(document);
  for (const SceneTimeline::FlameTime& flame : timeline.flames()) {
    const std::string& given = document.scene.flames[flame.flame].name;
    const std::string name = given.empty() ? std::to_string(flame.flame + 1) : given;
    if (!flame.files.empty())
      report.add_text("series " + name,
                      "files " + std::to_string(flame.first) + " to " + std::to_string(flame.last) +
                          " at " + readable(flame.frame_rate, Dimension::frequency) +
                          (flame.missing.empty() ? std::string()
                                                 : ", MISSING: " + numbers_text(flame.missing)));
    if (!flame.table.empty())
      report.add_text("time table " + name,
                      "'" + flame.table + "': " + flame.table_columns + " from " +
                          readable(flame.table_first, Dimension::time) + " to " +
                          readable(flame.table_last, Dimension::time));
    list.push_back({{"flame", flame.flame},
                    {"files", flame.files},
                    {"frame_rate_hz", flame.frame_rate},
                    {"first", flame.first},
                    {"last", flame.last},
                    {"missing", flame.missing},
                    {"table", flame.table},
                    {"table_first_s", flame.table_first},
                    {"table_last_s", flame.table_last}});
  }
  report.add_json("time", list);
  if (!(timeline.frame_rate() > 0)) return;
  const int first = timeline.first_frame(), last = timeline.last_frame();
  const SensorSpec& sensor = document.scene.camera.sensor;
  std::string text = last < first ? "none: the exposure is longer than the flames are known"
                                  : std::to_string(first) + " to " + std::to_string(last) + " at " +
                                        readable(timeline.frame_rate(), Dimension::frequency);
  if (sensor.exposure_time > 0)
    text += ", exposed for " + readable(sensor.exposure_time, Dimension::time);
  report.add_text("frames", text);
  report.add_json("frames", {{"first", first},
                             {"last", last},
                             {"rate_hz", timeline.frame_rate()},
                             {"exposure_s", sensor.exposure_time}});
}

}  // namespace

void describe_scene(const std::string& path, const std::vector<std::string>& set, Report& report) {
  std::vector<std::string> warnings;
  const SceneDocument document = read_valid_scene(path, set, &warnings);
  Scene scene = document.scene;
  const bool lines = std::any_of(scene.flames.begin(), scene.flames.end(),
                                 [](const FlameSpec& flame) { return !flame.lines.empty(); });
  if (lines) read_curves(scene, std::filesystem::path(path).parent_path().string());
  for (const std::string& warning : warnings) warn(warning);
  report.add("type", "scene", "type", "scene");
  if (scene.cameras.empty()) {
    add_camera(scene.camera, report);
  } else {
    nlohmann::json cameras = nlohmann::json::array();
    for (const CameraSpec& camera : scene.cameras) {
      report.add_text("camera " + camera.name,
                      "at " + readable_point(camera.position) + "; " + sensor_text(camera.sensor));
      report.add_text("  main lens", lens_text(camera.lens));
      report.add_text("  microlens array", array_text(camera.array));
      report.add_text("  focus", focus_text(camera.focus));
      if (!camera.pupil_filters.empty())
        report.add_text("  pupil filters", filters_text(camera.pupil_filters));
      cameras.push_back(camera_json(camera));
    }
    report.add_json("cameras", cameras);
  }
  nlohmann::json flames = nlohmann::json::array();
  for (std::size_t i = 0; i < scene.flames.size(); ++i) {
    const FlameSpec& flame = scene.flames[i];
    const std::string name = flame.name.empty() ? std::to_string(i + 1) : flame.name;
    report.add_text("flame " + name, flame_text(flame));
    const std::string key = "flames[" + std::to_string(i) + "]";
    for (std::size_t l = 0; l < flame.lines.size(); ++l) {
      const std::string kind = get_text(scene, key + ".lines[" + std::to_string(l) + "].kind");
      report.add_text("line " + kind, line_text(scene, flame.lines[l]));
    }
    flames.push_back({{"name", flame.name},
                      {"kind", flame.kind == FlameKind::vdb ? "vdb" : "layered"},
                      {"file", flame.file},
                      {"layers", flame.layers.size()},
                      {"lines", lines_json(scene, flame, key)},
                      {"position_m", {flame.position.x, flame.position.y, flame.position.z}}});
  }
  report.add_json("flames", flames);
  try {
    add_time(scene.cameras.empty() ? document : for_camera(document, scene.cameras.front().name),
             report);
  } catch (const Error& error) {  // the rest of the scene is worth knowing without its files
    warnings.emplace_back(error.what());
    warn(error.what());
  }
  nlohmann::json surfaces = nlohmann::json::array(), lights = nlohmann::json::array();
  for (std::size_t i = 0; i < scene.surfaces.size(); ++i) {
    const SolidSurfaceSpec& surface = scene.surfaces[i];
    const std::string key = "surfaces[" + std::to_string(i) + "]";
    const std::string shape = get_text(scene, key + ".shape");
    const std::string material = get_text(scene, key + ".material.kind");
    const std::string name = surface.name.empty() ? std::to_string(i + 1) : surface.name;
    report.add_text("surface " + name,
                    shape + ", " + material + " at " + readable_point(surface.position));
    surfaces.push_back(
        {{"name", surface.name},
         {"shape", shape},
         {"material", material},
         {"file", surface.file},
         {"position_m", {surface.position.x, surface.position.y, surface.position.z}}});
  }
  report.add_json("surfaces", surfaces);
  add_windows(scene, report);
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    const LightSpec& light = scene.lights[i];
    const std::string kind = get_text(scene, "lights[" + std::to_string(i) + "].kind");
    report.add_text(
        "light " + (light.name.empty() ? std::to_string(i + 1) : light.name),
        light.kind == LightKind::point ? kind + " at " + readable_point(light.position) : kind);
    lights.push_back({{"name", light.name}, {"kind", kind}});
  }
  report.add_json("lights", lights);
  nlohmann::json channels = nlohmann::json::array();
  for (const ChannelSpec& channel : scene.channels) {
    const std::string kind =
        get_text(scene, "channels[" + std::to_string(channels.size()) + "].kind");
    report.add_text("channel " + channel.name, describe_channel(channel));
    channels.push_back({{"name", channel.name},
                        {"kind", kind},
                        {"response", channel.response},
                        {"wavelength_m", channel.wavelength},
                        {"width_m", channel.width}});
  }
  report.add_json("channels", channels);
  const std::string estimator =
      scene.render.estimator == Estimator::forward ? "forward" : "backward";
  report.add(
      "render",
      estimator + ", " + std::to_string(scene.render.samples) + " samples, seed " +
          std::to_string(scene.render.seed),
      "render",
      {{"estimator", estimator}, {"samples", scene.render.samples}, {"seed", scene.render.seed}});
  report.add_json("warnings", warnings);
}

std::string complete_scene(const std::string& path, const std::vector<std::string>& set) {
  return write_scene(read_scene(path, set).scene);
}

}  // namespace plenoflame::cli
