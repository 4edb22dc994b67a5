#include "plenoflame/render/merge.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <system_error>

#include "choice.h"
#include "commands/add_option.h"
#include "commands/commands.h"
#include "commands/render/render_options.h"
#include "commands/series/sweep_set.h"
#include "messages.h"
#include "options.h"
#include "outputs.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/report.h"
#include "plenoflame/film/film.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/inverse/csr_matrix.h"
#include "run.h"
#include "terminal.h"

namespace plenoflame::cli {
namespace {

struct MergeArguments {
  std::vector<std::string> files;
  std::string output, compression;
  bool json = false;
};

/// "4 parts", and nothing for one.
void add_count(std::size_t count, const std::string& what, std::string& text) {
  if (count > 1) text += fmt::format("{}{} {}", text.empty() ? "" : " of ", count, what);
}

void merge_pictures(const MergeArguments& arguments, const std::stop_token& stop) {
  MergeCounts counts;
  const LightField all = merge_light_fields(arguments.files, stop, &counts);
  write_light_field(arguments.output, all, stop, exr_compression(arguments.compression));
  const LightFieldChannel& first = all.channels.front();
  double flux = 0;
  for (const float value : first.flux.pixels) flux += static_cast<double>(value);
  std::string of;
  add_count(counts.parts, "parts", of);
  add_count(counts.windows, "windows", of);
  add_count(counts.seeds, "seeds", of);
  Report report;
  report.add("merged",
             fmt::format("{} files{}", arguments.files.size(), of.empty() ? "" : ": " + of),
             "files", arguments.files.size());
  report.add_json("parts", counts.parts);
  report.add_json("windows", counts.windows);
  report.add_json("seeds", counts.seeds);
  report.add("samples", fmt::format("{:.6g}", all.samples), "samples", all.samples);
  report.add("flux", fmt::format("{:.4g} W over the image", flux), "flux", flux);
  const auto replicates = static_cast<int>(all.numbers.at("render.replicates"));
  if (!first.standard_error.empty() && replicates > 1) {
    const StatedError error = stated_error(first.flux, first.standard_error, replicates);
    report.add("error",
               fmt::format("{:.4g} % relative RMSE over lit pixels, below {:.4g} % with {:.4g} % "
                           "confidence",
                           100 * error.relative_rmse, 100 * error.bound, 100 * kErrorConfidence),
               "relative_error", error.relative_rmse);
    report.add_json("relative_error_bound", error.bound);
  }
  report.add("written", arguments.output, "output", arguments.output);
  print(report, arguments.json);
}

bool is_matrix(const std::string& file) {
  return file.ends_with(".npz") || file.ends_with(".h5");
}

void merge_matrices(const MergeArguments& arguments) {
  check_ending("-o", arguments.output, {".npz", ".h5", ".mtx"});
  const CsrMatrix<float> all = merge_csr(arguments.files);
  write_csr(arguments.output, all);
  Report report;
  report.add("merged", fmt::format("{} parts of a matrix", arguments.files.size()), "files",
             arguments.files.size());
  report.add("rows", std::to_string(all.rows()), "rows", all.rows());
  report.add("entries", std::to_string(all.entries()), "entries", all.entries());
  report.add("written", arguments.output, "output", arguments.output);
  print(report, arguments.json);
}

int run_merge(const MergeArguments& arguments, const std::stop_token& stop) {
  std::error_code error;
  if (std::filesystem::is_directory(arguments.files.front(), error)) {
    const std::vector<int> beyond = merge_sets(arguments.files, arguments.output, stop);
    if (const std::string warning = beyond_lattice_warning(beyond); !warning.empty()) warn(warning);
    Report report;
    report.add("merged", fmt::format("{} parts of a sweep", arguments.files.size()), "files",
               arguments.files.size());
    report.add_json("beyond_lattice", beyond);
    report.add("written", arguments.output, "output", arguments.output);
    print(report, arguments.json);
    return kSuccess;
  }
  check_writable(arguments.output);
  if (is_matrix(arguments.files.front())) {
    merge_matrices(arguments);
    return kSuccess;
  }
  check_ending("-o", arguments.output, {".exr"});
  merge_pictures(arguments, stop);
  return kSuccess;
}

}  // namespace

void register_merge(const Registry& registry) {
  const auto arguments = std::make_shared<MergeArguments>();
  CLI::App& command = add_command(registry, "merge", "Merge parts, windows or seeds of a picture",
                                  "plenoflame merge flame-part-*-of-4.exr -o flame.exr");
  command
      .add_option("FILES", arguments->files,
                  "Light fields (.exr) of one scene: all parts of 'render --part', adjacent "
                  "windows or different seeds. Or the folders of all parts of a 'sweep', or all "
                  "parts of 'operator --part' (.npz, .h5)")
      ->required();
  add_option(command, "-o,--output", arguments->output, "FILE",
             "Merged light field (.exr), folder of a sweep, or matrix (.npz, .h5 or .mtx)")
      ->check(written())
      ->required();
  add_option(command, "--compression", arguments->compression, "NAME", "See render (rle)")
      ->check(one_of({"none", "rle", "zip", "piz"}));
  command.add_flag("--json", arguments->json, "Print the figures as JSON");
  on_chosen(command, registry,
            [arguments](const std::stop_token& stop) { return run_merge(*arguments, stop); });
}

}  // namespace plenoflame::cli
