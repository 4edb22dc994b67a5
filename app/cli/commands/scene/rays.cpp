#include "plenoflame/render/ray_paths.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "choice.h"
#include "commands/add_option.h"
#include "commands/commands.h"
#include "commands/moment_options.h"
#include "commands/scene/ray_counts.h"
#include "commands/scene_input.h"
#include "medium_loader.h"
#include "messages.h"
#include "number_rows.h"
#include "options.h"
#include "outputs.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/report.h"
#include "plenoflame/image/atomic_file.h"
#include "run.h"
#include "terminal.h"

namespace plenoflame::cli {
namespace {

struct RaysArguments {
  std::string scene, camera, output;
  std::vector<std::string> pixels, windows, microlenses, points, statuses;
  std::vector<std::string> set;
  std::vector<int> types;
  std::string pixel_file, rays, random, seed, flame_samples, most;
  int threads = 0;
  MomentChoice moment;
  bool chief = false;
  bool json = false;
};

RaySelection selection_of(const RaysArguments& settings, std::uint64_t seed) {
  const std::map<std::string, RayStatus> known{{"reached", RayStatus::reached},
                                               {"vignetted", RayStatus::vignetted},
                                               {"reflected", RayStatus::total_internal_reflection},
                                               {"missed", RayStatus::missed}};
  RaySelection selection;
  for (const std::string& name : settings.statuses) selection.statuses.push_back(known.at(name));
  selection.types = settings.types;
  if (!settings.most.empty())
    selection.most = whole_number_option<std::uint64_t>("--most", settings.most, 1);
  selection.seed = seed;
  return selection;
}

RayCounts counts_of(const RayPaths& paths) {
  RayCounts counts;
  counts.rays = paths.rays.size();
  counts.vertices = paths.vertices.size();
  counts.channels = paths.channels;
  for (const RayPath& ray : paths.rays) {
    ++counts.by_status[static_cast<std::size_t>(ray.status.status)];
    counts.of_images += ray.weight > 0;
  }
  for (std::size_t c = 0; c < paths.channels.size(); ++c) {
    double flux = 0;
    for (std::size_t i = 0; i < paths.rays.size(); ++i)
      flux += paths.rays[i].weight * paths.radiance_of(i, c);
    counts.flux.push_back(flux);
  }
  return counts;
}

/// Pixels that are named one by one, by windows and by a file, in this order.
std::vector<Pixel> named_pixels(const RaysArguments& settings) {
  std::vector<Pixel> pixels;
  for (const std::string& text : settings.pixels) {
    const auto [column, row] = pair_option("--pixel", text, "X,Y");
    if (column < 0 || row < 0)
      throw UsageError("--pixel: columns and rows start at 0, not '" + text + "'");
    pixels.push_back({column, row});
  }
  for (const std::string& text : settings.windows) {
    const PixelWindow window = window_option("--window", text);
    for (int y = 0; y < window.height; ++y)
      for (int x = 0; x < window.width; ++x) pixels.push_back({window.x + x, window.y + y});
  }
  if (settings.pixel_file.empty()) return pixels;
  for (const NumberRow& row : read_number_rows(settings.pixel_file, {2}, "a pixel: column,row")) {
    const auto whole = [](double v) { return v >= 0 && v < 65536 && v == std::floor(v); };
    if (!whole(row.values[0]) || !whole(row.values[1]))
      throw InputError(row.at, "columns and rows are whole numbers from 0");
    pixels.push_back({static_cast<int>(row.values[0]), static_cast<int>(row.values[1])});
  }
  return pixels;
}

/// Each of them once, in the order of their first places.
std::vector<LensIndex> named_lenses(const RaysArguments& settings) {
  std::vector<LensIndex> lenses;
  for (const std::string& text : settings.microlenses) {
    const auto [q, r] = pair_option("--microlens", text, "Q,R");
    const LensIndex lens{q, r};
    if (std::find(lenses.begin(), lenses.end(), lens) == lenses.end()) lenses.push_back(lens);
  }
  return lenses;
}

int run_rays(const RaysArguments& settings, const std::stop_token& stop) {
  RenderSettings render;
  std::vector<Pixel> pixels = named_pixels(settings);
  if (!settings.rays.empty()) render.samples = whole_number_option("--rays", settings.rays, 2);
  const int random =
      settings.random.empty() ? 0 : whole_number_option("--random", settings.random, 1);
  const std::vector<LensIndex> lenses = named_lenses(settings);
  std::vector<Vec3> points;
  for (const std::string& text : settings.points) {
    const auto [x, y, z] = point_option("--point", text);
    points.push_back({x, y, z});
  }
  if (pixels.empty() && lenses.empty() && points.empty() && random == 0 && !settings.chief)
    throw UsageError(
        "no rays are chosen; give --pixel X,Y, --window X,Y,W,H, --microlens Q,R, --point X,Y,Z "
        "(may be repeated), --pixels FILE, --random N or --chief");
  check_writable(settings.output);

  const SceneDocument document =
      at_moment(read_camera_scene(settings.scene, settings.set, settings.camera), settings.moment);
  const ArraySpec& array = document.scene.camera.array;
  for (const int type : settings.types)
    if (!array.present || type < 0 || type >= static_cast<int>(array.types.size()))
      throw UsageError(fmt::format("--type: there is no type {}; the array has {}", type,
                                   array.present ? array.types.size() : 0));
  render.seed = settings.seed.empty()
                    ? document.scene.render.seed
                    : whole_number_option<std::uint64_t>("--seed", settings.seed, 0);
  Execution execution;
  execution.message = [](Severity severity, const std::string& text) {
    if (severity == Severity::warning) warn(text);
  };
  const CompiledScene scene = compile(document, medium_loader(), execution);
  const std::vector<Pixel> drawn = random_pixels(document.scene.camera.sensor, random, render.seed);
  pixels.insert(pixels.end(), drawn.begin(), drawn.end());

  RayPaths paths = empty_ray_paths(scene);
  if (!settings.flame_samples.empty())
    paths.flame_samples = whole_number_option("--flame-samples", settings.flame_samples, 1);
  execution.threads = settings.threads;
  {
    execution.stop = stop;
    add_pixel_rays(scene, render, pixels, execution, paths);
    for (const LensIndex lens : lenses)
      add_microlens_rays(scene, render, lens, execution, paths, pixels);
  }
  for (const Vec3 point : points) add_object_rays(scene, point, render.samples, paths);
  if (settings.chief) add_chief_rays(scene, paths);
  select_rays(selection_of(settings, render.seed), paths);
  write_ray_paths(settings.output, paths);
  Report report;
  report_ray_counts(counts_of(paths), report);
  print(report, settings.json);
  return kSuccess;
}

}  // namespace

void register_rays(const Registry& registry) {
  auto settings = std::make_shared<RaysArguments>();
  CLI::App& command = add_command(
      registry, "rays", "Export the paths of the rays of an image",
      "plenoflame rays examples/paper-flame-1m.toml --pixel 1500,1500 --rays 64 -o rays.vtp");
  command.add_option("SCENE", settings->scene, "Scene file (.toml)")->required();
  add_set_option(command, settings->set);
  add_camera_option(command, settings->camera);
  add_moment_options(command, settings->moment);
  add_option(command, "-o,--output", settings->output, "FILE",
             "File to write: .vtp (VTK PolyData), .csv, .json, or .npz (numpy)")
      ->check(written({".vtp", ".csv", ".json", ".npz"}))
      ->required();
  add_option(command, "--pixel", settings->pixels, "X,Y",
             "All rays of this pixel: column and row, from the top left; repeatable")
      ->allow_extra_args(false);
  add_option(command, "--window", settings->windows, "X,Y,W,H",
             "All rays of the pixels of this window; repeatable")
      ->allow_extra_args(false);
  add_option(command, "--pixels", settings->pixel_file, "FILE.csv",
             "All rays of these pixels: column,row on each line");
  add_option(command, "--microlens", settings->microlenses, "Q,R",
             "All rays through this microlens; repeatable")
      ->allow_extra_args(false);
  add_option(command, "--point", settings->points, "X,Y,Z",
             "Rays from this point of the world, e.g. \"1 m, 0 m, 5 mm\"; repeatable")
      ->allow_extra_args(false);
  add_option(command, "--random", settings->random, "N",
             "All rays of N different pixels drawn at random");
  command.add_flag("--chief", settings->chief, "The chief ray of every microlens");
  add_option(command, "--rays", settings->rays, "N",
             "Rays per point, or per pixel and microlens, as --samples of render (default: 64)");
  add_option(
      command, "--flame-samples", settings->flame_samples, "N",
      "Vertices with temperature and absorption on each ray within the flames (default: none)");
  add_option(command, "--status", settings->statuses, "STATUS",
             "Keep only rays of this status: reached, vignetted, reflected, missed; repeatable")
      ->check(one_of({"reached", "vignetted", "reflected", "missed"}))
      ->allow_extra_args(false);
  add_option(command, "--type", settings->types, "T",
             "Keep only rays through microlenses of this type, from 0; repeatable")
      ->allow_extra_args(false);
  add_option(command, "--most", settings->most, "N",
             "Keep at most N rays, drawn evenly; their sums are not fluxes");
  add_threads_option(command, settings->threads);
  add_option(command, "--seed", settings->seed, "N", "Seed (default: the scene's)");
  command.add_flag("--json", settings->json, "Print the figures as JSON");
  on_chosen(command, registry,
            [settings](const std::stop_token& stop) { return run_rays(*settings, stop); });
}

}  // namespace plenoflame::cli
