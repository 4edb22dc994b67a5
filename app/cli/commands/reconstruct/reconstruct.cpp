#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "commands/commands.h"
#include "commands/reconstruct/reconstruct_input.h"
#include "commands/reconstruct/reconstruct_options.h"
#include "commands/reconstruct/reconstruct_page.h"
#include "commands/reconstruct/reconstruct_ranks.h"
#include "commands/scene_input.h"
#include "file_set.h"
#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/image/light_field.h"
#include "plenoflame/inverse/shared_assembly.h"
#include "plenoflame/scene/cameras.h"
#include "progress_bar.h"
#include "ranks.h"
#include "run.h"
#include "terminal.h"

namespace plenoflame::cli {
namespace {

void write_residual(const std::string& path, const LightField& picture, const std::string& channel,
                    const Image& residual, const Image& explained) {
  LightField out = picture;
  out.channels = {{channel, residual, {}}};
  out.layers = {{"explained", explained}};
  out.unit = "W";
  out.texts["reconstruct.residual"] = "measured - explained";
  write_light_field(path, out);
}

/// The lines for people, aligned.
std::string plain_text(const Report& report) {
  std::size_t width = 0;
  for (const auto& line : report.lines()) width = std::max(width, line.first.size());
  std::string all;
  for (const auto& [label, text] : report.lines())
    all += fmt::format("{:<{}} {}\n", label + ':', width + 1, text);
  return all;
}

/// The scenes with the cameras that were refined.
void write_refined(const ReconstructArguments& arguments, const std::vector<CameraScene>& views,
                   const std::vector<CameraSpec>& cameras, FileSet& files) {
  for (std::size_t s = 0; s < arguments.refined_scenes.size(); ++s) {
    Scene scene = read_scene(arguments.scenes[s], arguments.set).scene;
    for (std::size_t v = 0; v < views.size(); ++v)
      if (views[v].file == arguments.scenes[s]) scene = replace_camera(scene, cameras[v]);
    files.write(arguments.refined_scenes[s],
                [&](const std::string& name) { write_scene_file(name, scene); });
  }
}

void write_reports(const ReconstructArguments& arguments, const ReconstructPage& page,
                   std::size_t frame, std::size_t frames, FileSet& files) {
  for (const std::string& name : arguments.reports) {
    const std::string path = frame_name(name, frame, frames);
    const std::string text = path.ends_with(".html")   ? reconstruct_page(page)
                             : path.ends_with(".json") ? page.report.json_text()
                                                       : plain_text(page.report);
    files.write(path, [&](const std::string& file) { write_file(file, text); });
  }
}

/// @param ranks that help; nullptr: there are none
int run_reconstruct(const ReconstructArguments& arguments, JobCommunicator* ranks,
                    const std::stop_token& stop) {
  // Before any work: wrong options, files that do not fit, outputs that cannot be written.
  reconstruction_settings(arguments, 1);
  if (ranks && !(arguments.refine.empty() && !arguments.refine_axis))
    throw UsageError("--refine moves cameras, which other ranks do not: run it in one process");
  const std::vector<CameraScene> views =
      read_camera_scenes(arguments.scenes, arguments.set, arguments.cameras);
  const std::size_t frames = frame_count(arguments, views.size());
  check_reconstruct_files(arguments, frames);
  ProgressBar bar(arguments.quiet);
  Execution execution;
  execution.threads = arguments.threads;
  if (ranks && execution.threads == 0) execution.threads = default_threads(*ranks);
  bar.connect(execution);
  execution.stop = stop;
  const ReconstructCameras cameras = compile_cameras(arguments, views, execution);
  // A picture that does not belong here is refused before the work on others begins.
  for (std::size_t f = frames; f-- > 1;) read_frame(arguments, cameras, f, execution);
  FramePictures pictures = read_frame(arguments, cameras, 0, execution);
  Reconstructor reconstructor(arguments, cameras, pictures.measurements, execution);
  std::optional<SharedAssembly> assembly;
  if (ranks) {
    announce_reconstruction(arguments, reconstructor.unknowns_request(), *ranks);
    reconstructor.share(assembly.emplace(*ranks));
  }
  nlohmann::json all = nlohmann::json::array();
  bool complete = true;
  for (std::size_t f = 0; f < frames && complete; ++f) {
    if (f > 0) pictures = read_frame(arguments, cameras, f, execution);
    warn_of_pictures(pictures.measurements, pictures.names, execution);
    const ReconstructResult result = reconstructor.frame(pictures.measurements, execution);
    bar.finish();
    complete = result.figures.complete;
    const std::string output = frame_name(arguments.output, f, frames);
    FileSet files;  // of a frame: all of them appear, or none
    files.write(output, [&](const std::string& name) {
      write_estimate(name, result, reconstructor.unknowns());
    });
    for (std::size_t v = 0; v < views.size() && !arguments.residuals.empty(); ++v)
      files.write(arguments.residuals[v * frames + f], [&](const std::string& name) {
        write_residual(name, pictures.pictures[v], cameras.channel_name(0),
                       result.figures.residual[v], result.figures.explained[v]);
      });
    if (f == 0) write_refined(arguments, views, reconstructor.camera_specs(), files);
    const Report report = reconstructor.report(result, output, execution);
    std::vector<std::string> names;
    for (std::size_t k = 0; k < cameras.channels.size(); ++k)
      for (const std::string& picture : pictures.names)
        names.push_back(picture + ", " + cameras.channel_name(k));
    names.resize(result.figures.residual.size());
    write_reports(arguments,
                  {result, reconstructor.unknowns(), report, names, reconstructor.truth()}, f,
                  frames, files);
    files.commit();
    if (frames == 1)
      print(report, arguments.json);
    else if (arguments.json)
      all.push_back(nlohmann::json::parse(report.json_text()));
    else
      std::cout << (f > 0 ? "\n" : "") << "frame " << f + 1 << " of " << frames << '\n'
                << plain_text(report);
  }
  if (frames > 1 && arguments.json) std::cout << nlohmann::json{{"frames", all}}.dump(2) << '\n';
  return complete ? kSuccess : kFailure;
}

}  // namespace

void register_reconstruct(const Registry& registry) {
  const auto arguments = std::make_shared<ReconstructArguments>();
  CLI::App& command = add_command(
      registry, "reconstruct", "The flame back from pictures of it",
      "plenoflame reconstruct front.toml side.toml --images front.exr side.exr -o flame.vdb");
  add_reconstruct_options(command, *arguments, registry.action.file);
  on_chosen(command, registry, [arguments, ranks = registry.ranks](const std::stop_token& stop) {
    return run_reconstruct(*arguments, ranks, stop);
  });
}

}  // namespace plenoflame::cli
