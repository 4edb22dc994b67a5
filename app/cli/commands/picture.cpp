#include <CLI/CLI.hpp>
#include <charconv>
#include <map>
#include <memory>

#include "commands/commands.h"
#include "options.h"
#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"
#include "run.h"
#include "vtk_commands.h"

namespace plenoflame::cli {
namespace {

struct Settings {
  PictureRequest request;
  std::vector<std::string> pixels, microlenses, points;
  std::string view = "scene", colour = "type", size;
  bool no_flame = false, no_insets = false, no_axes = false;
};

/// "A,B" with a separator: whole numbers. @throws UsageError
std::array<int, 2> pair_option(const char* option, const std::string& text, char separator) {
  std::array<int, 2> values{};
  const char* const end = text.data() + text.size();
  const auto [middle, first] = std::from_chars(text.data(), end, values[0]);
  if (first == std::errc{} && middle != end && *middle == separator) {
    const auto [stop, second] = std::from_chars(middle + 1, end, values[1]);
    if (second == std::errc{} && stop == end) return values;
  }
  throw UsageError(std::string(option) + ": '" + text + "' is not of the form A" + separator +
                   "B: two whole numbers");
}

std::array<double, 3> point_option(const std::string& text) {
  const std::size_t first = text.find(','),
                    second = first == std::string::npos ? first : text.find(',', first + 1);
  if (second == std::string::npos)
    throw UsageError("--point: '" + text + "' is not of the form X,Y,Z: three lengths");
  const auto part = [&](std::size_t begin, std::size_t end) {
    return quantity_option("--point", text.substr(begin, end - begin), Dimension::length);
  };
  return {part(0, first), part(first + 1, second), part(second + 1, text.size())};
}

int run_picture(const Settings& settings) {
  PictureRequest request = settings.request;
  for (const std::string& text : settings.pixels)
    request.pixels.push_back(pair_option("--pixel", text, ','));
  for (const std::string& text : settings.microlenses)
    request.microlenses.push_back(pair_option("--microlens", text, ','));
  for (const std::string& text : settings.points) request.points.push_back(point_option(text));
  if (!settings.size.empty()) request.size = pair_option("--size", settings.size, 'x');
  for (const int side : request.size)
    if (side < 100 || side > 8000) throw UsageError("--size: each side must be 100 to 8000 pixels");
  if (!request.output.ends_with(".png"))
    throw UsageError("-o: '" + request.output + "' must end in .png");
  request.view =
      std::map<std::string, int>{{"scene", 0}, {"camera", 1}, {"array", 2}, {"flame", 3}}.at(
          settings.view);
  request.by_status = settings.colour == "status";
  request.flame = !settings.no_flame;
  request.insets = !settings.no_insets;
  request.axes = !settings.no_axes;
  check_writable(request.output);
  make_picture(request);
  return kSuccess;
}

}  // namespace

void register_picture(const Registry& registry) {
  auto settings = std::make_shared<Settings>();
  PictureRequest& request = settings->request;
  CLI::App& command =
      add_command(registry, "picture", "Draw a scene in 3-D: flame, camera, rays",
                  "plenoflame picture examples/lenslets-30.toml --pixel 150,150 -o scene.png\n"
                  "xvfb-run -a plenoflame picture examples/lenslets-30.toml -o scene.png");
  command.add_option("SCENE", request.scene, "Scene file (.toml)")->required();
  command.add_option("-o,--output", request.output, "Picture to write (.png)")
      ->required()
      ->option_text("FILE");
  command
      .add_option("--view", settings->view,
                  "scene: all of it, with insets of camera and microlenses; camera; array: a few "
                  "microlenses; flame (scene)")
      ->check(CLI::IsMember({"scene", "camera", "array", "flame"}))
      ->option_text("VIEW");
  command.add_option("--image", request.image, "Light field (.exr) to show on the sensor")
      ->option_text("RAW");
  command.add_option("--rays-file", request.rays_file, "Rays to draw (.vtp), written by rays")
      ->option_text("FILE");
  command.add_option("--pixel", settings->pixels, "Draw this pixel's rays; may be repeated")
      ->option_text("X,Y")
      ->allow_extra_args(false);
  command
      .add_option("--microlens", settings->microlenses,
                  "Draw this microlens' rays; may be repeated")
      ->option_text("Q,R")
      ->allow_extra_args(false);
  command
      .add_option("--point", settings->points,
                  "Draw rays from this point of the world towards the camera; may be repeated")
      ->option_text("X,Y,Z")
      ->allow_extra_args(false);
  command.add_flag("--chief", request.chief, "Draw the chief ray of every microlens");
  command.add_option("--random", request.random, "Draw the rays of N pixels drawn at random")
      ->check(CLI::NonNegativeNumber)
      ->option_text("N");
  command.add_option("--rays", request.rays, "Rays per pixel and microlens, and per point (32)")
      ->check(CLI::Range(2, 1 << 20))
      ->option_text("N");
  command.add_option("--most", request.most, "Draw at most N rays (2000)")
      ->check(CLI::Range(1, 10000000))
      ->option_text("N");
  command
      .add_option("--colour-by", settings->colour,
                  "Colour of rays: type of the microlens, or status: how they ended (type)")
      ->check(CLI::IsMember({"type", "status"}))
      ->option_text("WHAT");
  command.add_option("--size", settings->size, "Of the picture in pixels (1200x800)")
      ->option_text("WxH");
  command.add_flag("--no-flame", settings->no_flame, "Leave out the flame");
  command.add_flag("--no-insets", settings->no_insets, "Leave out the insets");
  command.add_flag("--no-axes", settings->no_axes, "Leave out the axes");
  on_chosen(command, registry, [settings] { return run_picture(*settings); });
}

}  // namespace plenoflame::cli
