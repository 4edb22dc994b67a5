#include "plenoflame/lightfield/refocus.h"
#include "number_range.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands/add_option.h"
#include "commands/commands.h"
#include "commands/render/light_field_output.h"
#include "file_set.h"
#include "options.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/part_of_progress.h"
#include "plenoflame/base/report.h"
#include "progress_bar.h"
#include "run.h"
#include "terminal.h"

namespace plenoflame::cli {
namespace {

struct RefocusArguments {
  RawArguments raw;
  std::string depth, depths;
  int size = 0;
  double aperture = 1;
  bool all_types = false, all_in_focus = false, exr = false;
};

/// "0.9m:1.1m:11": first, last, number of them.
std::vector<double> depths_of(const RefocusArguments& settings) {
  if (settings.depth.empty() == settings.depths.empty())
    throw UsageError("give either --depth, e.g. \"1 m\", or --depths, e.g. 0.9m:1.1m:11");
  if (!settings.depth.empty())
    return {quantity_option("--depth", settings.depth, Dimension::length)};
  const std::string& text = settings.depths;
  const auto first = text.find(':'),
             second = text.find(':', first == std::string::npos ? first : first + 1);
  if (second == std::string::npos)
    throw UsageError("--depths must be FIRST:LAST:COUNT, e.g. 0.9m:1.1m:11, not '" + text + "'");
  const int count =
      whole_number_option("--depths FIRST:LAST:COUNT", text.substr(second + 1), 2, 1000);
  const double a = quantity_option("--depths", text.substr(0, first), Dimension::length);
  const double b =
      quantity_option("--depths", text.substr(first + 1, second - first - 1), Dimension::length);
  std::vector<double> depths;
  for (int i = 0; i < count; ++i) depths.push_back(a + (b - a) * i / (count - 1));
  return depths;
}

int run_refocus(const RefocusArguments& settings, const std::stop_token& stop) {
  const std::vector<double> depths = depths_of(settings);
  if (settings.all_in_focus && (depths.size() < 3 || depths[1] <= depths[0]))
    throw UsageError(
        "--all-in-focus needs at least 3 depths, the nearest first: give them with "
        "--depths, e.g. 0.9m:1.1m:11");
  check_folder(settings.raw.output, settings.raw.force);
  const RawLightField raw = read_raw(settings.raw);
  const Camera camera(raw.camera);
  for (const double depth : depths) check_refocus_depth(camera, depth);
  RefocusSettings how;
  how.width = settings.size;
  how.aperture = settings.aperture;
  how.sharp_types = !settings.all_types;
  how.channel = find_channel(raw.field, settings.raw.channel).name;
  Execution execution;
  execution.threads = settings.raw.threads;
  execution.stop = stop;
  ProgressBar bar(false);
  bar.connect(execution);
  const Execution first = part_of_progress(execution, 0, 0.5);
  const Execution planes_left = part_of_progress(execution, 0.5, 0.5);
  const MicroImages micro = raw.micro_images(true, first);
  std::vector<RefocusedImage> planes;
  FocusStack stack;
  if (settings.all_in_focus) {
    stack = focus_stack(raw.field, micro, depths, how, planes_left);
    planes = std::move(stack.planes);
  } else {
    const double share = 1.0 / static_cast<double>(depths.size());
    for (const double depth : depths) {
      how.depth = depth;
      const double from = share * static_cast<double>(planes.size());
      planes.push_back(refocus(raw.field, micro, how, part_of_progress(planes_left, from, share)));
    }
  }
  bar.finish();
  std::vector<NamedImage> images;
  nlohmann::json list = nlohmann::json::array();
  for (RefocusedImage& result : planes) {
    const double depth = result.depth;
    char name[60];
    if (depths.size() == 1)
      std::snprintf(name, sizeof name, "refocus_%.4fm", depth);
    else
      std::snprintf(name, sizeof name, "refocus_%03zu_%.4fm", images.size(), depth);
    list.push_back({{"depth", depth},
                    {"name", name},
                    {"pixel", result.pixel},
                    {"corner", {result.corner.x, result.corner.y}},
                    {"size", {result.image.width, result.image.height}}});
    images.push_back({name,
                      std::move(result.image),
                      {{"refocus.depth", depth},
                       {"refocus.pixel", result.pixel},
                       {"refocus.corner_x", result.corner.x},
                       {"refocus.corner_y", result.corner.y}}});
  }
  if (settings.all_in_focus) images.push_back({"all_in_focus", std::move(stack.all_in_focus), {}});
  ResultFolder folder(settings.raw.output);
  double white = 0;
  const std::string unit = raw.field.unit + "/(m^2 sr)";
  folder.write([&](const std::string& path) {
    white = write_pngs(path, images, raw.field, execution);
    if (settings.exr) write_exrs(path, images, how.channel, unit, raw.field, execution);
    if (settings.all_in_focus)
      write_depth(path, stack.depth, stack.confidence, depths.front(), depths.back(), raw.field);
  });
  folder.commit();

  Report report;
  report.add("folder", settings.raw.output, "folder", settings.raw.output);
  report.add("pictures", std::to_string(images.size()), "pictures", list);
  report.add("size",
             std::to_string(images[0].image.width) + " x " + std::to_string(images[0].image.height),
             "size", {images[0].image.width, images[0].image.height});
  report.add("pixel on the object", readable(list[0]["pixel"].get<double>(), Dimension::length),
             "pixel", list[0]["pixel"]);
  report.add("channel", how.channel, "channel", how.channel);
  report.add("white in the pictures", readable_in(white, unit), "white", white);
  report.add_json("unit", unit);
  print(report, settings.raw.json);
  return kSuccess;
}

}  // namespace

void register_refocus(const Registry& registry) {
  auto settings = std::make_shared<RefocusArguments>();
  CLI::App& command = add_command(registry, "refocus",
                                  "Refocus a light field to other distances, after the exposure",
                                  "plenoflame refocus flame.exr -o stack --depths 0.9m:1.1m:11");
  add_raw_input(command, settings->raw, "Folder for the pictures");
  add_option(command, "--depth", settings->depth, "LENGTH",
             "Distance from the front of the main lens, e.g. \"1 m\"");
  add_option(command, "--depths", settings->depths, "A:B:N",
             "Several distances: FIRST:LAST:COUNT, e.g. 0.9m:1.1m:11");
  add_option(command, "--size", settings->size, "N", "Pixels across; without it, one per microlens")
      ->check(CLI::Range(1, 20000));
  add_option(command, "--aperture", settings->aperture, "A",
             "Synthetic aperture over the main lens' diameter, above 0 to 1 (1)")
      ->check(number_between(1e-3, 1.0));
  command.add_flag("--all-in-focus", settings->all_in_focus,
                   "With --depths: all_in_focus.png, sharp everywhere, and the depth map of an "
                   "opaque scene, depth.exr and depth.png");
  command.add_flag("--all-types", settings->all_types,
                   "Use all types of microlenses equally, in place of weights by sharpness");
  command.add_flag("--exr", settings->exr, "Write radiances as EXR as well");
  add_raw_options(command, settings->raw);
  on_chosen(command, registry,
            [settings](const std::stop_token& stop) { return run_refocus(*settings, stop); });
}

}  // namespace plenoflame::cli
