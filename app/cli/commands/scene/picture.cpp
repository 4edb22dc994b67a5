#include <CLI/CLI.hpp>
#include <map>
#include <memory>

#include "choice.h"
#include "commands/add_option.h"
#include "commands/commands.h"
#include "commands/moment_options.h"
#include "commands/scene_input.h"
#include "number_range.h"
#include "options.h"
#include "outputs.h"
#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"
#include "run.h"
#include "vtk_commands.h"

namespace plenoflame::cli {
namespace {

struct PictureArguments {
  PictureRequest request;
  std::vector<std::string> pixels, microlenses, points, set;
  std::string view = "scene", colour = "type", size;
  MomentChoice moment;
  bool no_flame = false, no_surfaces = false, no_insets = false, no_axes = false;
};

int run_picture(const PictureArguments& settings) {
  PictureRequest request = settings.request;
  for (const std::string& text : settings.pixels)
    request.pixels.push_back(pair_option("--pixel", text, "X,Y"));
  for (const std::string& text : settings.microlenses)
    request.microlenses.push_back(pair_option("--microlens", text, "Q,R"));
  for (const std::string& text : settings.points)
    request.points.push_back(point_option("--point", text));
  if (!settings.size.empty()) request.size = pair_option("--size", settings.size, "WxH", 'x');
  for (const int side : request.size)
    if (side < 100 || side > 8000) throw UsageError("--size: each side must be 100 to 8000 pixels");
  request.view =
      std::map<std::string, int>{{"scene", 0}, {"camera", 1}, {"array", 2}, {"flame", 3}}.at(
          settings.view);
  request.by_status = settings.colour == "status";
  request.flame = !settings.no_flame;
  request.surfaces = !settings.no_surfaces;
  request.insets = !settings.no_insets;
  request.axes = !settings.no_axes;
  check_writable(request.output);
  check_is_scene(request.scene);
  if (!settings.set.empty() || settings.moment.given())
    request.values =
        at_moment(read_valid_scene(request.scene, settings.set), settings.moment).scene;
  make_picture(request);
  return kSuccess;
}

}  // namespace

void register_picture(const Registry& registry) {
  auto settings = std::make_shared<PictureArguments>();
  PictureRequest& request = settings->request;
  CLI::App& command = add_command(
      registry, "picture", "Draw a scene in 3-D: flame, camera, rays (in builds with VTK)",
      "plenoflame picture examples/lenslets-30.toml --pixel 150,150 -o scene.png\n"
      "xvfb-run -a plenoflame picture examples/lenslets-30.toml -o scene.png");
  command.add_option("SCENE", request.scene, "Scene file (.toml)")->required();
  add_set_option(command, settings->set);
  add_moment_options(command, settings->moment);
  add_option(command, "--camera", request.cameras, "NAME",
             "Camera of the insets and of --view camera (the first), cameras whose rays are drawn "
             "(all); repeatable")
      ->allow_extra_args(false);
  add_option(command, "-o,--output", request.output, "FILE", "Picture to write (.png)")
      ->check(written({".png"}))
      ->required();
  add_option(command, "--view", settings->view, "VIEW",
             "scene: all of it, with insets of camera and microlenses; camera; array: a few "
             "microlenses; flame: with the solid bodies (scene)")
      ->check(one_of({"scene", "camera", "array", "flame"}));
  add_option(command, "--image", request.image, "RAW", "Light field (.exr) to show on the sensor");
  add_option(command, "--rays-file", request.rays_file, "FILE",
             "Rays to draw (.vtp), written by rays");
  add_option(command, "--pixel", settings->pixels, "X,Y", "Draw this pixel's rays; may be repeated")
      ->allow_extra_args(false);
  add_option(command, "--microlens", settings->microlenses, "Q,R",
             "Draw this microlens' rays; may be repeated")
      ->allow_extra_args(false);
  add_option(command, "--point", settings->points, "X,Y,Z",
             "Draw rays from this point of the world towards the camera; may be repeated")
      ->allow_extra_args(false);
  command.add_flag("--chief", request.chief, "Draw the chief ray of every microlens");
  add_option(command, "--random", request.random, "N", "Draw the rays of N pixels drawn at random")
      ->check(number_from(0));
  add_option(command, "--rays", request.rays, "N",
             "Rays per pixel and microlens, and per point (32)")
      ->check(CLI::Range(2, 1 << 20));
  add_option(command, "--most", request.most, "N", "Draw at most N rays (2000)")
      ->check(CLI::Range(1, 10000000));
  add_option(command, "--colour-by", settings->colour, "WHAT",
             "Colour of rays: type of the microlens, or status: how they ended (type)")
      ->check(one_of({"type", "status"}));
  add_option(command, "--size", settings->size, "WxH", "Size of the picture in pixels (1200x800)");
  command.add_flag("--no-flame", settings->no_flame, "Leave out the flame");
  command.add_flag("--no-surfaces", settings->no_surfaces, "Leave out the solid surfaces");
  command.add_flag("--no-insets", settings->no_insets, "Leave out the insets");
  command.add_flag("--no-axes", settings->no_axes, "Leave out the axes");
  on_chosen(command, registry, [settings] { return run_picture(*settings); });
}

}  // namespace plenoflame::cli
