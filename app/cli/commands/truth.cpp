#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <memory>
#include <sstream>

#include "commands/commands.h"
#include "options.h"
#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/lightfield/ground_truth.h"
#include "plenoflame/scene/scene_file.h"
#include "progress_bar.h"
#include "report.h"
#include "run.h"

namespace plenoflame::cli {
namespace {

struct Settings {
  std::string input, output, points, projections, attach, chief;
  int threads = 0;
  bool json = false;
};

/// Points of the world, one "x,y,z" in metres per line; # begins a comment, a header is skipped.
std::vector<Vec3> read_points(const std::string& path) {
  std::vector<Vec3> points;
  std::istringstream text(read_file(path));
  int number = 0;
  for (std::string line; std::getline(text, line);) {
    ++number;
    line = line.substr(0, line.find('#'));
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    double values[3] = {};
    std::istringstream words(line);
    std::string word;
    int count = 0;
    bool good = true, is_header = true;
    while (std::getline(words, word, ',')) {
      const auto begin = word.find_first_not_of(" \t\r");
      const auto end = word.find_last_not_of(" \t\r");
      double value = 0;
      if (begin == std::string::npos) {
        good = is_header = false;
        break;
      }
      const char* stop = word.data() + end + 1;
      const auto [at, error] = std::from_chars(word.data() + begin, stop, value);
      good = good && error == std::errc() && at == stop && std::isfinite(value) && count < 3;
      is_header = is_header && at == word.data() + begin;
      if (count < 3) values[count] = value;
      ++count;
    }
    if (good && count == 3)
      points.push_back({values[0], values[1], values[2]});
    else if (number > 1 || !is_header)
      throw InputError(SourcePosition{path, number}, "this is not a point: x,y,z in metres");
  }
  if (points.empty()) throw InputError(SourcePosition{path}, "there is no point in it");
  return points;
}

std::string projection_csv(const Camera& camera, const std::vector<Vec3>& points,
                           const Execution& execution, std::size_t& images) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(10);
  text << "point,x,y,z,q,r,type,column,row\n";
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!(camera.to_world().inverse().point(points[i]).z > 0))
      throw InputError(fmt::format("point {} at {}, {}, {} m is not in front of the camera", i,
                                   points[i].x, points[i].y, points[i].z));
    Execution own = execution;
    own.progress = [&](Progress progress) {
      progress.fraction =
          (static_cast<double>(i) + progress.fraction) / static_cast<double>(points.size());
      execution.progress(progress);
    };
    for (const PointTruth& image : project_point(camera, points[i], own)) {
      ++images;
      const auto& types = camera.spec().array.types;
      text << i << ',' << points[i].x << ',' << points[i].y << ',' << points[i].z << ','
           << image.lens.q << ',' << image.lens.r << ','
           << (types.empty() ? std::string("none")
                             : types[static_cast<std::size_t>(image.type)].name)
           << ',' << image.pixel.x << ',' << image.pixel.y << '\n';
    }
  }
  return text.str();
}

int run_truth(const Settings& settings) {
  if (settings.points.empty() != settings.projections.empty())
    throw UsageError("--points and --projections belong together");
  if (settings.output.empty() && settings.projections.empty() && settings.attach.empty() &&
      settings.chief.empty())
    throw UsageError(
        "truth writes nothing without --output, --projections, --attach or "
        "--chief-rays");
  if (!settings.output.empty() && settings.output == settings.projections)
    throw UsageError("--output and --projections are the same file");
  for (const auto& [option, path] : {std::pair{"--output", settings.output},
                                     {"--projections", settings.projections},
                                     {"--attach", settings.attach},
                                     {"--chief-rays", settings.chief}})
    if (!path.empty()) check_not_overwritten(option, path, settings.input);
  LightField field = settings.attach.empty() && settings.chief.empty()
                         ? read_light_field_header(settings.input)
                         : read_light_field(settings.input);
  if (field.scene_text.empty())
    throw InputError(settings.input + " does not say which camera took it: it holds no scene");
  const SceneDocument document = parse_scene(field.scene_text, settings.input);
  const Camera camera(document.scene.camera);
  Execution execution;
  execution.threads = settings.threads;
  ProgressBar bar(false);
  bar.connect(execution);
  Report report;
  if (!settings.projections.empty()) {
    std::size_t images = 0;
    const auto points = read_points(settings.points);
    write_file(settings.projections, projection_csv(camera, points, execution, images));
    report.add("points", std::to_string(points.size()), "points", points.size());
    report.add("images of them", std::to_string(images), "point_images", images);
  }
  if (settings.output.empty() && settings.attach.empty() && settings.chief.empty()) {
    bar.finish();
    report.print(settings.json);
    return kSuccess;
  }
  check_raw_image(field, document.scene.camera, settings.input);
  const MicroImages images(camera, false, execution);
  const auto truth = micro_image_truth(images);
  const std::string csv = micro_image_csv(truth, document.scene.camera);
  if (!settings.output.empty()) write_file(settings.output, csv);
  if (!settings.attach.empty()) {
    LightField with = field;
    with.texts["truth.micro_images"] = csv;
    write_light_field(settings.attach, with);
  }
  if (!settings.chief.empty()) {
    add_chief_rays(images, field,
                   execution);  // beside the image: a light field has at least a channel
    write_light_field(settings.chief, field);
  }
  bar.finish();
  report.add("micro-images", std::to_string(truth.size()), "micro_images", truth.size());
  report.add(
      "spacing",
      readable_number(images.spacing() / document.scene.camera.sensor.pixel_pitch) + " pixels",
      "spacing_pixels", images.spacing() / document.scene.camera.sensor.pixel_pitch);
  report.print(settings.json);
  return kSuccess;
}

}  // namespace

void register_truth(const Registry& registry) {
  auto settings = std::make_shared<Settings>();
  CLI::App& command = add_command(
      registry, "truth", "Ground truth of a raw image: micro-images, projected points, chief rays",
      "plenoflame truth flame.exr -o micro-images.csv");
  command.add_option("RAW", settings->input, "Light field (.exr) written by render")->required();
  command
      .add_option("-o,--output", settings->output,
                  "Micro-images as CSV: lens, type, centre and radius in pixels")
      ->option_text("FILE.csv");
  command
      .add_option("--attach", settings->attach,
                  "The raw image with that table as attribute plenoflame.text.truth.micro_images")
      ->option_text("FILE.exr");
  command
      .add_option("--points", settings->points,
                  "Points of the world to project: x,y,z in metres, one per line")
      ->option_text("FILE.csv");
  command
      .add_option("--projections", settings->projections,
                  "Where they are imaged: a line for every microlens that sees the point")
      ->option_text("FILE.csv");
  command
      .add_option("--chief-rays", settings->chief,
                  "The raw image with the chief ray of every pixel: layers chief.x .y .z [m], "
                  "chief.dx .dy .dz, world")
      ->option_text("FILE.exr");
  command.add_option("--threads", settings->threads, "Worker threads; 0: one per processor (0)")
      ->check(CLI::Range(0, 1024))
      ->option_text("N");
  command.add_flag("--json", settings->json, "Print the figures as JSON");
  on_chosen(command, registry, [settings] { return run_truth(*settings); });
}

}  // namespace plenoflame::cli
