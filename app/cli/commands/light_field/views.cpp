#include "plenoflame/lightfield/views.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands/add_option.h"
#include "commands/commands.h"
#include "commands/render/light_field_output.h"
#include "file_set.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/part_of_progress.h"
#include "plenoflame/base/report.h"
#include "plenoflame/math/readable.h"
#include "progress_bar.h"
#include "run.h"
#include "terminal.h"

namespace plenoflame::cli {
namespace {

struct ViewsArguments {
  RawArguments raw;
  ViewArguments views;
  std::string type;
  int grid = ViewSettings{}.grid, epipolar_row = -1, epipolar_column = -1;
  bool raw_flux = false, exr = false, sheet_only = false;
};

/// Number of the type of microlens with this name; -1 for an empty one.
int type_of(const CameraSpec& camera, const std::string& name) {
  if (name.empty()) return -1;
  std::string names;
  for (std::size_t k = 0; k < camera.array.types.size(); ++k) {
    if (camera.array.types[k].name == name) return static_cast<int>(k);
    names += (k > 0 ? ", " : "") + camera.array.types[k].name;
  }
  throw InputError("the camera has no type of microlens named '" + name + "'; it has: " + names);
}

int run_views(const ViewsArguments& settings, const std::stop_token& stop) {
  check_folder(settings.raw.output, settings.raw.force);
  const RawLightField raw = read_raw(settings.raw);
  ViewSettings how = settings.views.settings();
  how.grid = settings.grid;
  how.white_correction = !settings.raw_flux;
  how.type = type_of(raw.camera, settings.type);
  how.channel = find_channel(raw.field, settings.raw.channel).name;
  Execution execution;
  execution.threads = settings.raw.threads;
  execution.stop = stop;
  ProgressBar bar(false);
  bar.connect(execution);
  const MicroImages micro =
      raw.micro_images(how.white_correction, part_of_progress(execution, 0, 0.5));
  const Views views = extract_views(raw.field, micro, how, part_of_progress(execution, 0.5, 0.5));
  bar.finish();
  std::vector<NamedImage> images{{"contact", contact_sheet(views), {}}};
  if (!settings.sheet_only)
    for (const View& view : views.views) {
      char name[40];
      std::snprintf(name, sizeof name, "view_%02d_%02d", view.row, view.column);
      images.push_back({name,
                        view.image,
                        {{"view.column", view.column},
                         {"view.row", view.row},
                         {"view.offset_x", view.offset.x},
                         {"view.offset_y", view.offset.y},
                         {"view.lens_step", views.lens_step}}});
    }
  const auto add_slice = [&](const char* name, int line, bool vertical) {
    if (line >= 0)
      images.push_back({name, epipolar_slice(views, line, vertical), {{"epipolar.line", line}}});
  };
  add_slice("epipolar_row", settings.epipolar_row, false);
  add_slice("epipolar_column", settings.epipolar_column, true);
  ResultFolder folder(settings.raw.output);
  double white = 0;
  folder.write([&](const std::string& path) {
    white = write_pngs(path, images, raw.field, execution);
    if (settings.exr) write_exrs(path, images, how.channel, views.unit, raw.field, execution);
  });
  folder.commit();

  const Image& first = views.views.front().image;
  Report report;
  report.add("folder", settings.raw.output, "folder", settings.raw.output);
  report.add("views", std::to_string(settings.grid) + " x " + std::to_string(settings.grid), "grid",
             settings.grid);
  report.add("size of a view", std::to_string(first.width) + " x " + std::to_string(first.height),
             "size", {first.width, first.height});
  report.add("channel", how.channel, "channel", how.channel);
  report.add("resampling", settings.views.resampling, "resampling", settings.views.resampling);
  report.add("white in the pictures", readable_in(white, views.unit), "white", white);
  report.add_json("unit", views.unit);
  nlohmann::json list = nlohmann::json::array();
  for (const View& view : views.views)
    list.push_back({{"row", view.row},
                    {"column", view.column},
                    {"offset_pixels", {view.offset.x, view.offset.y}}});
  report.add_json("views", list);
  print(report, settings.raw.json);
  return kSuccess;
}

}  // namespace

void register_views(const Registry& registry) {
  auto settings = std::make_shared<ViewsArguments>();
  CLI::App& command = add_command(
      registry, "views", "Make sub-aperture views: the scene as seen from points of the main lens",
      "plenoflame views flame.exr -o views --grid 5");
  add_raw_input(command, settings->raw, "Folder for contact.png and the views");
  add_option(command, "--grid", settings->grid, "N", "Views along each side, 1 to 99 (7)")
      ->check(CLI::Range(1, 99));
  add_view_options(command, settings->views);
  add_option(command, "--type", settings->type, "NAME",
             "Only microlenses of this type, by name; without it, all");
  add_option(command, "--epipolar-row", settings->epipolar_row, "ROW",
             "Also the epipolar slice of this row")
      ->check(CLI::Range(0, 100000));
  add_option(command, "--epipolar-column", settings->epipolar_column, "COLUMN",
             "Also the epipolar slice of this column")
      ->check(CLI::Range(0, 100000));
  command.add_flag("--raw-flux", settings->raw_flux,
                   "Flux per pixel as recorded, in place of radiances with vignetting corrected");
  command.add_flag("--exr", settings->exr, "Write the views as EXR as well");
  command.add_flag("--sheet-only", settings->sheet_only,
                   "Write the contact sheet, not the single views");
  add_raw_options(command, settings->raw);
  on_chosen(command, registry,
            [settings](const std::stop_token& stop) { return run_views(*settings, stop); });
}

}  // namespace plenoflame::cli
