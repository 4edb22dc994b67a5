#include "commands/scene/info.h"

#include <CLI/CLI.hpp>
#include <array>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string_view>

#include "commands/commands.h"
#include "commands/scene/ray_counts.h"
#include "commands/scene_input.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/printable.h"
#include "plenoflame/image/light_field.h"
#include "plenoflame/image/open_file.h"
#include "plenoflame/image/png_file.h"
#include "plenoflame/math/readable.h"
#include "plenoflame/scene/scene_file.h"
#include "run.h"
#include "terminal.h"

namespace plenoflame::cli {
namespace {

struct InfoArguments {
  std::string file;
  std::vector<std::string> set;
  bool scene = false;
  bool json = false;
};

/// The scene of a light field: as it stands there, or with some of its values replaced.
std::string scene_inside(const std::string& path, const std::vector<std::string>& set) {
  const LightField field = read_light_field_header(path);
  return set.empty() ? printable(field.scene_text, true)
                     : write_scene(read_scene_of(field, path, set).scene);
}

enum class Kind { light_field, png, poly_data, vdb, scene, ray_csv, ray_json, unknown };

/// By the file's first bytes, and for texts by its name.
Kind kind_of(const std::string& path) {
  if (std::filesystem::is_directory(path))
    throw FileError("cannot read '" + path + "': it is a folder; give a file");
  if (std::filesystem::is_fifo(path))
    throw FileError("cannot read '" + path + "': it is a pipe; give a file");
  struct Closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  const std::unique_ptr<std::FILE, Closer> file(open_for_reading(path));
  std::array<char, 512> start{};
  const std::size_t count = std::fread(start.data(), 1, start.size(), file.get());
  const std::string_view bytes(start.data(), count);
  if (bytes.starts_with("\x76\x2f\x31\x01")) return Kind::light_field;
  if (bytes.starts_with("\x89PNG\r\n\x1a\n")) return Kind::png;
  if (bytes.starts_with(" BDV")) return Kind::vdb;
  if (bytes.find("<VTKFile") != std::string_view::npos) return Kind::poly_data;
  if (std::filesystem::path(path).extension() == ".toml") return Kind::scene;
  if (bytes.starts_with("ray,column,row,")) return Kind::ray_csv;
  if (bytes.starts_with("{\"channels\":")) return Kind::ray_json;
  return Kind::unknown;
}

void describe_rays(const RayCounts& counts, Report& report) {
  report.add("type", "ray paths", "type", "ray paths");
  report_ray_counts(counts, report);
}

int run_info(const InfoArguments& settings) {
  const Kind kind = kind_of(settings.file);
  if (!settings.set.empty() && kind != Kind::scene &&
      !(settings.scene && kind == Kind::light_field))
    throw UsageError("--set: '" + settings.file + "' is not a scene (.toml)");
  if (settings.scene) {
    if (kind == Kind::scene)
      std::cout << complete_scene(settings.file, settings.set);
    else if (kind == Kind::light_field)
      std::cout << scene_inside(settings.file, settings.set);
    else
      throw UsageError("--scene: '" + settings.file + "' is neither a scene (.toml) nor a light " +
                       "field (.exr)");
    return kSuccess;
  }
  Report report;
  report.add("file", settings.file, "file", settings.file);
  switch (kind) {
    case Kind::light_field:
      describe_light_field(settings.file, report);
      break;
    case Kind::png:
      describe_png(settings.file, report);
      break;
    case Kind::poly_data:
      describe_poly_data(settings.file, report);
      break;
    case Kind::scene:
      describe_scene(settings.file, settings.set, report);
      break;
    case Kind::ray_csv:
      describe_rays(count_rays_of_csv(settings.file), report);
      break;
    case Kind::ray_json:
      describe_rays(count_rays_of_json(settings.file), report);
      break;
    case Kind::vdb:
#if defined(PLENOFLAME_HAS_VOLUMES)
      describe_vdb(settings.file, report);
      break;
#else
      throw InputError("'" + settings.file +
                       "' is a flame (.vdb), and this plenoflame was built without OpenVDB");
#endif
    case Kind::unknown: {
      std::error_code no_file;  // a device, for one
      const bool empty = std::filesystem::is_empty(settings.file, no_file);
      throw InputError(
          "'" + settings.file + "' is " + (empty && !no_file ? "empty, so it is " : "") +
          "not a file that Plenoflame reads: scene (.toml), flame (.vdb), light field (.exr), "
          "ray paths (.vtp, .csv, .json), picture (.png)");
    }
  }
  print(report, settings.json);
  return kSuccess;
}

}  // namespace

void describe_png(const std::string& path, Report& report) {
  const PngImage image = read_png(path);
  report.add("type", "picture", "type", "picture");
  report.add("size", std::to_string(image.width) + " x " + std::to_string(image.height), "size",
             {image.width, image.height});
  report.add("channels", image.channels == 3 ? "RGB" : "grey", "channels", image.channels);
  report.add("bits", std::to_string(image.bits), "bits", image.bits);
  if (image.significant_bits > 0)
    report.add("significant bits", std::to_string(image.significant_bits), "significant_bits",
               image.significant_bits);
  const std::string curve = image.transfer == Transfer::linear ? "linear" : "display";
  report.add("curve", curve, "curve", curve);
  for (const auto& [keyword, text] : image.texts) report.add_text(keyword, text);
  report.add_json("texts", image.texts);
}

void register_info(const Registry& registry) {
  auto settings = std::make_shared<InfoArguments>();
  CLI::App& command =
      add_command(registry, "info", "Describe a scene, flame, light field, ray or picture file",
                  "plenoflame info flame.exr --json");
  command
      .add_option("FILE", settings->file,
                  "Scene (.toml), flame (.vdb), light field (.exr), ray paths (.vtp, .csv, .json) "
                  "or picture (.png)")
      ->required();
  add_set_option(command, settings->set);
  command.add_flag("--scene", settings->scene, "Print only the scene, with its presets resolved");
  command.add_flag("--json", settings->json, "Print the figures as JSON");
  on_chosen(command, registry, [settings] { return run_info(*settings); });
}

}  // namespace plenoflame::cli
