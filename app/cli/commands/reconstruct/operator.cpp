#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <deque>
#include <iostream>
#include <memory>
#include <sstream>

#include "commands/commands.h"
#include "commands/part_option.h"
#include "commands/reconstruct/operator_options.h"
#include "commands/scene_input.h"
#include "file_set.h"
#include "medium_loader.h"
#include "options.h"
#include "plenoflame/base/available_memory.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/report.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/scene/scene_file.h"
#include "progress_bar.h"
#include "run.h"
#include "terminal.h"

namespace plenoflame::cli {
namespace {

/// @param cameras their names where there are several, empty otherwise
std::string pixels_csv(const CameraRays& rays, const std::vector<std::string>& cameras) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << (cameras.empty() ? "row,column,line\n" : "row,column,line,camera\n");
  for (std::size_t i = 0; i < rays.rows.size(); ++i) {
    const CameraRays::Row& row = rays.rows[i];
    text << i << ',' << row.column << ',' << row.row;
    if (!cameras.empty()) text << ',' << cameras[static_cast<std::size_t>(row.view)];
    text << '\n';
  }
  return text.str();
}

std::string places_csv(const Unknowns& unknowns) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(10);
  text << "unknown,x,y,z,volume\n";
  for (std::size_t j = 0; j < unknowns.size(); ++j) {
    const Vec3 p = unknowns.place(j);
    text << j << ',' << p.x << ',' << p.y << ',' << p.z << ',' << unknowns.volume(j) << '\n';
  }
  return text.str();
}

/// All that rows depend on, in words.
std::string operator_work(const OperatorRequest& request,
                          const std::vector<const CompiledScene*>& scenes) {
  std::string text;
  for (const auto& row : setting_rows<UnknownsRequest>())
    text += text_of_row(row, request.unknowns) + '\n';
  for (const auto& row : setting_rows<OperatorRequest>())
    if (row.name != "form") text += text_of_row(row, request) + '\n';
  for (const CompiledScene* scene : scenes) text += write_scene(scene->scene);
  return text;
}

int run_operator(const OperatorArguments& settings, const std::stop_token& stop) {
  for (const std::string& path : {settings.output, settings.pixels, settings.places})
    if (!path.empty()) check_writable(path);
  check_operator(settings);
  const Part part = settings.part.empty() ? Part{} : part_option("--part", settings.part);
  if (!part.is_whole() && settings.output.ends_with(".mtx"))
    throw UsageError("--part: parts of a matrix are written as .npz or .h5, which merge reads");
  const std::vector<CameraScene> views =
      read_camera_scenes({settings.scene}, settings.set, settings.cameras);
  ProgressBar bar(settings.quiet);
  Execution execution;
  execution.threads = settings.threads;
  bar.connect(execution);
  execution.stop = stop;
  std::deque<CompiledScene> scenes;
  std::vector<const CompiledScene*> cameras;
  std::vector<std::string> names;
  for (const CameraScene& view : views) {
    scenes.push_back(compile(view.document, medium_loader(), execution,
                             {scenes.empty() ? nullptr : &scenes.front()}, {IssueCode::no_flame}));
    cameras.push_back(&scenes.back());
    if (views.size() > 1) names.push_back(view.document.scene.camera.name);
  }
  const std::unique_ptr<OperatorProblem> made =
      make_operator_problem(settings, cameras, settings.scene, execution, part);
  const EmissionProblem& problem = made->problem;
  const CameraRays& rays = made->rays;
  const std::size_t entries = estimated_entries(problem);
  // The matrix, its arrays, and the file.
  require_memory(3 * kBytesOfEntry * static_cast<double>(entries),
                 fmt::format("a matrix of {:.3g} entries", static_cast<double>(entries)),
                 "take a coarser --grid, larger blocks of pixels (--bin), or fewer --rays");
  const CsrMatrix<float> matrix = make_emission_matrix(problem, execution);
  bar.finish();
  CsrPart own{part, 0};
  if (!part.is_whole()) own.work = csr_work(operator_work(settings, cameras));
  FileSet files;
  files.write(settings.output, [&](const std::string& name) { write_csr(name, matrix, own); });
  if (!settings.pixels.empty())
    files.write(settings.pixels,
                [&](const std::string& name) { write_file(name, pixels_csv(rays, names)); });
  if (!settings.places.empty())
    files.write(settings.places,
                [&](const std::string& name) { write_file(name, places_csv(*made->unknowns)); });
  files.commit();
  Report report;
  report.add("rows", std::to_string(matrix.rows()), "rows", matrix.rows());
  report.add("unknowns", std::to_string(matrix.columns()), "unknowns", matrix.columns());
  report.add("entries", std::to_string(matrix.entries()), "entries", matrix.entries());
  report.add("rays", std::to_string(rays.ray_count()), "rays", rays.ray_count());
  report.add(
      "samples are of",
      problem.absorption.empty() ? "emission, W/(m^3 sr)" : "the source function, W/(m^2 sr)",
      "model", problem.absorption.empty() ? "emission" : "source");
  report.add("written", settings.output, "output", settings.output);
  print(report, settings.json);
  return kSuccess;
}

}  // namespace

void register_operator(const Registry& registry) {
  auto settings = std::make_shared<OperatorArguments>();
  CLI::App& command = add_command(
      registry, "operator", "The matrix from a flame's samples to the pixels' fluxes",
      "plenoflame operator examples/lenslets-30.toml --grid 16 --pixels rows.csv -o A.npz");
  add_operator_options(command, *settings, registry.action.file);
  on_chosen(command, registry,
            [settings](const std::stop_token& stop) { return run_operator(*settings, stop); });
}

}  // namespace plenoflame::cli
