#pragma once
#include <fstream>
#include <sstream>
#include <string>

#include "plenoflame/base/error.h"
#include "plenoflame/scene/scene_file.h"
#include "support/source_folder.h"

/// Scenes and helpers that the tests of scene files share.
namespace plenoflame::test {

/// The message of the InputError that a call throws; empty when it throws none.
template <class Call>
std::string message_of(Call&& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

inline std::string source_text(const std::string& path) {
  std::ifstream file(std::string(PLENOFLAME_SOURCE_DIR) + "/" + path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// Every member different from its default, lists of different lengths, odd numbers and texts.
inline Scene full_scene() {
  Scene scene;
  scene.file = "full.toml";
  CameraSpec& camera = scene.camera;
  camera.position = {0.1, -0.2, 1.0 / 3};
  camera.look_direction = {0.6, 0.8, -0.0};
  camera.up = {0, 0.1, 2};
  camera.lens.model = LensModel::ideal;
  camera.lens.surfaces = {{0.3, 0.02426, 1.5, 0.12, false},
                          {-0.3, 0, 1, 0.119, false},
                          {kInfinity, 0.001, 1, 0.1, true}};
  camera.lens.surfaces[0].conic = -0.7;
  camera.lens.surfaces[0].aspheric = {1.0 / 3, 0, -2e9};
  camera.lens.surfaces[0].glass = "constant 1.5";
  camera.lens.focal_length = 0.3040987;
  camera.lens.diameter = 0.1;
  ArraySpec& array = camera.array;
  array.present = true;
  array.lattice = Lattice::square;
  array.model = LensModel::ideal;
  array.pitch = 1e-4;
  array.diameter = 9.9e-5;
  array.thickness = 5e-5;
  array.opaque_between = false;
  array.rotation = 0.3;
  array.offset = {1e-6, -2e-6};
  array.sensor_distance = 2.534e-4;
  array.measured_from = ArrayReference::vertex;
  camera.array.spacing_error = -1.5e-5;
  camera.array.centre_jitter = 4e-7;
  camera.array.focal_jitter = 0.013;
  camera.array.tilt = {1e-3, -2e-3};
  camera.lens.decentre = {1e-4, -3e-4};
  camera.lens.tilt = {-0.01, 0.02};
  camera.array.jitter_seed = 0xFFFFFFFFFFFFFFF0u;
  camera.array.types = {{"type \"1\"", 2.25e-4, kInfinity, 1.5, 1e-3},
                        {"a\\b\n\t\x7f", 2.25e-4, -3e-4, 1.59, -2e-3},
                        {"\xC3\xA4\xE2\x82\xAC", kInfinity, 2.25e-4, 1.69, 0}};
  camera.array.types[0].glass = "constant 1.5";
  camera.sensor = {3000, 2001, 1e-5};
  camera.sensor.frame_rate = 29.97;
  camera.sensor.exposure_begin = 1e-3 / 3;
  camera.sensor.exposure_steps = 11;
  camera.focus = {FocusMode::best, 0.4272409, 0.1 + 0.2, "type \"1\""};
  FlameSpec layered;
  layered.name = "first";
  layered.position = {1, 2, -0.029};
  layered.rotation = {0.1, -0.2, 0.3};
  layered.scale = 1.0 / 7;
  layered.layers = {{"core", {0, 0, 0.014}, {0.004, 0.0041, 0.012}, 1200, 1.0},
                    {"", {1e-3, 0, 0}, {0.1, 1, 10}, 1650.5, 30}};
  layered.interpolation = Interpolation::constant;
  FlameSpec grid;
  grid.kind = FlameKind::vdb;
  grid.name = "#2";
  grid.file = "sub folder/candle.vdb";
  grid.temperature = {"T", "degC", 1234.5, -0.125};
  grid.absorption = {"k", "1/mm", 1e-3, 7};
  grid.layers = {{"unused", {0, 0, 0}, {1, 1, 1}, 300, 0.5}};
  grid.lines = {{LineKind::custom, 517.3e-9, 2e-9, {"glow", "W/cm^3", 3, -1}},
                {LineKind::na_d, 0, 0, {}}};
  grid.brightness = 2.0 / 3;
  grid.time = {1e3 / 3, 7, "sub folder/time.csv"};
  scene.flames = {layered, grid};
  scene.channels = {{"red", ChannelKind::band, 650e-9, 10e-9},
                    {"total", ChannelKind::total, 1e-9, 2e-9}};
  SolidSurfaceSpec tube;
  tube.shape = SolidShape::cylinder;
  tube.name = "tube";
  tube.position = {0.1, -0.25, 3};
  tube.rotation = {-0.1, 0.2, 0.7};
  tube.radius = 0.012;
  tube.height = 0.3;
  tube.caps = false;
  tube.extent = {2, kInfinity};
  tube.size = {0.1, 0.2, 1.0 / 7};
  tube.file = "unused.obj";
  tube.file_unit = 1e-3;
  tube.material = {MaterialKind::blackbody, 0.9, 1234.5, 1e4, MaterialSides::front, {}};
  tube.material.texture = {TextureKind::dots, 0.05, 0.01, 9, 7, 0.4, {0.2, 0.3}, "chart.png"};
  scene.surfaces = {tube, SolidSurfaceSpec{}};
  scene.lights = {{LightKind::parallel, "sun", {1, 2, 3}, {0, 0.6, -0.8}, 0.39, 2.5, 1000, 7, 5800},
                  LightSpec{}};
  scene.render = {Estimator::forward, 17, 0xFFFFFFFFFFFFFFFEu, 5, false};
  scene.develop = {5e-6, 12, ToneCurve::linear};
  return scene;
}

}  // namespace plenoflame::test
