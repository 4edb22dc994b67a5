#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <limits>
#include <memory>

#include "commands/add_option.h"
#include "commands/commands.h"
#include "commands/scene_input.h"
#include "file_set.h"
#include "number_rows.h"
#include "options.h"
#include "outputs.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/report.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/lightfield/ground_truth.h"
#include "plenoflame/render/projections.h"
#include "progress_bar.h"
#include "run.h"
#include "terminal.h"

namespace plenoflame::cli {
namespace {

constexpr int kRays = 4096;

struct TruthArguments {
  std::string input, output, points, projections, rays, attach, chief;
  std::vector<std::string> set;
  int threads = 0;
  bool json = false;
};

std::vector<Vec3> read_points(const std::string& path) {
  std::vector<Vec3> points;
  for (const NumberRow& row : read_number_rows(path, {3}, "a point: x,y,z in metres"))
    points.push_back({row.values[0], row.values[1], row.values[2]});
  return points;
}

std::string projection_csv(const Camera& camera, const std::vector<Vec3>& points,
                           const std::vector<PointProjection>& projections) {
  std::string text = "point,x,y,z,q,r,type,column,row,centroid_column,centroid_row,spread,share\n";
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const auto& types = camera.spec().array.types;
  for (const PointProjection& image : projections) {
    const Vec3 point = points[image.point];
    text += fmt::format(
        "{},{},{},{},{},{},{}", image.point, point.x, point.y, point.z, image.lens.q, image.lens.r,
        types.empty() ? std::string("none") : types[static_cast<std::size_t>(image.type)].name);
    const Vec2 chief = image.chief.value_or(Vec2{kNone, kNone});
    const PointImage light = image.light.value_or(PointImage{{}, -1, kNone, kNone, kNone, 0});
    for (const double value :
         {chief.x, chief.y, light.column, light.row, light.spread, light.share})
      text += fmt::format(",{:.10g}", value);
    text += '\n';
  }
  return text;
}

int run_truth(const TruthArguments& settings, const std::stop_token& stop) {
  const int rays = settings.rays.empty() ? kRays : whole_number_option("--rays", settings.rays, 1);
  if (!settings.rays.empty() && settings.projections.empty())
    throw UsageError("--rays needs --projections");
  if (settings.points.empty() != settings.projections.empty())
    throw UsageError("--points and --projections belong together");
  if (settings.output.empty() && settings.projections.empty() && settings.attach.empty() &&
      settings.chief.empty())
    throw UsageError(
        "there is nothing to write; give --output, --projections, --attach or --chief-rays");
  LightField field = settings.attach.empty() && settings.chief.empty()
                         ? read_light_field_header(settings.input)
                         : read_light_field(settings.input);
  if (field.scene_text.empty())
    throw InputError(settings.input + " holds no scene, so its camera is not known");
  const SceneDocument document = read_scene_of(field, settings.input, settings.set);
  const Camera camera(document.scene.camera);
  Execution execution;
  execution.threads = settings.threads;
  execution.stop = stop;
  ProgressBar bar(false);
  bar.connect(execution);
  Report report;
  FileSet files;
  if (!settings.projections.empty()) {
    const auto points = read_points(settings.points);
    const std::vector<PointProjection> projections =
        project_points(camera, points, rays, execution);
    const std::string csv = projection_csv(camera, points, projections);
    const auto in_part = std::ranges::count_if(
        projections, [](const PointProjection& image) { return !image.chief; });
    files.write(settings.projections, [&](const std::string& name) { write_file(name, csv); });
    report.add("points", std::to_string(points.size()), "points", points.size());
    report.add("images of them", std::to_string(projections.size()), "point_images",
               projections.size());
    report.add("through part of a lens",
               std::to_string(in_part) + ": without the ray through its middle",
               "point_images_in_part", in_part);
  }
  if (settings.output.empty() && settings.attach.empty() && settings.chief.empty()) {
    bar.finish();
    files.commit();
    print(report, settings.json);
    return kSuccess;
  }
  check_raw_image(field, document.scene.camera, settings.input);
  const MicroImages images(camera, false, execution);
  const auto truth = micro_image_truth(images);
  const std::string csv = micro_image_csv(truth, document.scene.camera);
  if (!settings.output.empty())
    files.write(settings.output, [&](const std::string& name) { write_file(name, csv); });
  if (!settings.attach.empty()) {
    LightField with = field;
    with.texts["truth.micro_images"] = csv;
    files.write(settings.attach,
                [&](const std::string& name) { write_light_field(name, with, stop); });
  }
  if (!settings.chief.empty()) {
    add_chief_rays(images, field,
                   execution);  // beside the image: a light field has at least a channel
    files.write(settings.chief,
                [&](const std::string& name) { write_light_field(name, field, stop); });
  }
  bar.finish();
  files.commit();
  report.add("micro-images", std::to_string(truth.size()), "micro_images", truth.size());
  report.add(
      "spacing",
      readable_number(images.spacing() / document.scene.camera.sensor.pixel_pitch) + " pixels",
      "spacing_pixels", images.spacing() / document.scene.camera.sensor.pixel_pitch);
  print(report, settings.json);
  return kSuccess;
}

}  // namespace

void register_truth(const Registry& registry) {
  auto settings = std::make_shared<TruthArguments>();
  CLI::App& command = add_command(
      registry, "truth", "Ground truth of a raw image: micro-images, projected points, chief rays",
      "plenoflame truth flame.exr -o micro-images.csv");
  command.add_option("RAW", settings->input, "Light field (.exr) written by render")->required();
  add_set_option(command, settings->set);
  add_option(command, "-o,--output", settings->output, "FILE.csv",
             "Micro-images as CSV: lens, type, centre and radius in pixels")
      ->check(written());
  add_option(
      command, "--attach", settings->attach, "FILE.exr",
      "Raw image with the table of micro-images as attribute plenoflame.text.truth.micro_images")
      ->check(written());
  add_option(command, "--points", settings->points, "FILE.csv",
             "Points of the world: x,y,z in metres, one per line");
  add_option(command, "--projections", settings->projections, "FILE.csv",
             "Images of --points in each microlens that sees them: by the ray through its centre "
             "and by the centroid of the light")
      ->check(written());
  add_option(command, "--rays", settings->rays, "N",
             "Rays over the aperture for the centroids, for each point (default: 4096)");
  add_option(command, "--chief-rays", settings->chief, "FILE.exr",
             "Raw image with the chief ray of every pixel: layers chief.x .y .z [m], chief.dx .dy "
             ".dz, world")
      ->check(written());
  add_threads_option(command, settings->threads);
  command.add_flag("--json", settings->json, "Print the figures as JSON");
  on_chosen(command, registry,
            [settings](const std::stop_token& stop) { return run_truth(*settings, stop); });
}

}  // namespace plenoflame::cli
