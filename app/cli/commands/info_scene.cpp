#include <algorithm>
#include <filesystem>
#include <iostream>

#include "commands/info.h"
#include "commands/scene_input.h"
#include "options.h"
#include "plenoflame/scene/scene_file.h"
#include "plenoflame/scene/scene_schema.h"
#include "plenoflame/scene/spectral.h"

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
  return std::string(array.lattice == Lattice::hexagonal ? "hexagonal" : "square") + ", pitch " +
         readable(array.pitch, Dimension::length) + ", " + std::to_string(array.types.size()) +
         (array.types.size() == 1 ? " type" : " types") + ", " +
         readable(array.sensor_distance, Dimension::length) + " in front of the sensor";
}

std::string focus_text(const FocusSpec& focus) {
  if (focus.mode == FocusMode::distance)
    return "lens at " + readable(focus.lens_distance, Dimension::length);
  return std::string(focus.mode == FocusMode::best ? "best" : "paraxial") + ", object at " +
         readable(focus.object_distance, Dimension::length) + " sharp on " + focus.conjugate;
}

std::string place(Vec3 p) {
  return readable(p.x, Dimension::length) + ", " + readable(p.y, Dimension::length) + ", " +
         readable(p.z, Dimension::length);
}

std::string flame_text(const FlameSpec& flame) {
  std::string text = flame.kind == FlameKind::vdb ? "grids of '" + flame.file + "'"
                                                  : std::to_string(flame.layers.size()) + " layers";
  return text + " at " + place(flame.position);
}

std::string channel_text(const ChannelSpec& channel) {
  if (channel.kind == ChannelKind::total) return "all wavelengths";
  const std::string quantum = channel.photons ? ", counting photons" : "";
  if (channel.kind == ChannelKind::named) return "response " + channel.response + quantum;
  if (channel.kind == ChannelKind::curve)
    return (channel.file.empty() ? std::string("curve") : "curve of '" + channel.file + "'") +
           quantum;
  return readable(channel.width, Dimension::length) +
         (channel.kind == ChannelKind::line ? " wide line at " : " around ") +
         readable(channel.wavelength, Dimension::length) + quantum;
}

/// An emission line, and what each channel sees of it.
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

}  // namespace

void describe_scene(const std::string& path, Report& report) {
  std::vector<std::string> warnings;
  Scene scene = read_valid_scene(path, &warnings).scene;
  const bool lines = std::any_of(scene.flames.begin(), scene.flames.end(),
                                 [](const FlameSpec& flame) { return !flame.lines.empty(); });
  if (lines) read_curves(scene, std::filesystem::path(path).parent_path().string());
  for (const std::string& warning : warnings)
    std::cerr << "plenoflame: warning: " << warning << '\n';
  const CameraSpec& camera = scene.camera;
  const SensorSpec& sensor = camera.sensor;
  report.add("type", "scene", "type", "scene");
  report.add("sensor",
             std::to_string(sensor.columns) + " x " + std::to_string(sensor.rows) + " pixels of " +
                 readable(sensor.pixel_pitch, Dimension::length),
             "sensor", {sensor.columns, sensor.rows});
  report.add_json("pixel_pitch_m", sensor.pixel_pitch);
  report.add("main lens", lens_text(camera.lens), "main_lens", lens_text(camera.lens));
  report.add("microlens array", array_text(camera.array), "microlens_array",
             array_text(camera.array));
  report.add("focus", focus_text(camera.focus), "focus", focus_text(camera.focus));
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
  nlohmann::json surfaces = nlohmann::json::array(), lights = nlohmann::json::array();
  for (std::size_t i = 0; i < scene.surfaces.size(); ++i) {
    const SolidSurfaceSpec& surface = scene.surfaces[i];
    const std::string key = "surfaces[" + std::to_string(i) + "]";
    const std::string shape = get_text(scene, key + ".shape");
    const std::string material = get_text(scene, key + ".material.kind");
    const std::string name = surface.name.empty() ? std::to_string(i + 1) : surface.name;
    report.add_text("surface " + name, shape + ", " + material + " at " + place(surface.position));
    surfaces.push_back(
        {{"name", surface.name},
         {"shape", shape},
         {"material", material},
         {"file", surface.file},
         {"position_m", {surface.position.x, surface.position.y, surface.position.z}}});
  }
  report.add_json("surfaces", surfaces);
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    const LightSpec& light = scene.lights[i];
    const std::string kind = get_text(scene, "lights[" + std::to_string(i) + "].kind");
    report.add_text("light " + (light.name.empty() ? std::to_string(i + 1) : light.name),
                    light.kind == LightKind::point ? kind + " at " + place(light.position) : kind);
    lights.push_back({{"name", light.name}, {"kind", kind}});
  }
  report.add_json("lights", lights);
  nlohmann::json channels = nlohmann::json::array();
  for (const ChannelSpec& channel : scene.channels) {
    const std::string kind =
        get_text(scene, "channels[" + std::to_string(channels.size()) + "].kind");
    report.add_text("channel " + channel.name, channel_text(channel));
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

std::string complete_scene(const std::string& path) {
  return write_scene(read_scene_file(path).scene);
}

}  // namespace plenoflame::cli
