#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <set>

#include "commands/add_option.h"
#include "commands/commands.h"
#include "commands/reconstruct/operator_options.h"
#include "commands/render/render_options.h"
#include "commands/scene_input.h"
#include "commands/series/sweep_plan.h"
#include "options.h"
#include "outputs.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/part.h"
#include "plenoflame/image/atomic_file.h"
#include "run.h"

namespace plenoflame::cli {
namespace {

struct SubmitArguments {
  std::vector<std::string> scenes;
  std::string output, sweep, matrix, options, parts = "1", threads = "1", time, memory, partition;
  bool slurm = false;
};

/// A picture of the array: of each all parts.
struct SubmittedPicture {
  std::string scene, camera;  ///< camera: empty where the scene has one
  std::string whole;          ///< name of the picture without .exr
};

/// An array of tasks for the batch system.
struct JobArray {
  std::string name;
  int parts = 1, threads = 1;
  std::vector<std::string> options;  ///< of the command that a task runs
};

/// The text as one word of the shell.
std::string shell_word(const std::string& text) {
  if (!text.empty() &&
      text.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                             "_-+=:,./%@") == std::string::npos)
    return text;
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

/// The options for the command, as the shell would part them. @throws UsageError for an open quote
std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> words;
  bool within = false;
  char quote = 0;
  for (const char c : text) {
    if (quote == 0 && (c == ' ' || c == '\t' || c == '\n')) {
      within = false;
      continue;
    }
    if (!within) words.emplace_back();
    within = true;
    if (quote == 0 && (c == '"' || c == '\''))
      quote = c;
    else if (c == quote)
      quote = 0;
    else
      words.back() += c;
  }
  if (quote != 0) throw UsageError("--options: a quote is not closed");
  return words;
}

/// Reads options as the job will, so that one that waited for a day does not end with them.
/// @param own options that the script itself gives @param scene of the arguments, a word that is no
/// option
/// @throws UsageError
void read_options(CLI::App& command, const std::vector<std::string>& words,
                  std::initializer_list<const char*> own, const std::string& scene) {
  try {
    command.parse(std::vector<std::string>(words.rbegin(), words.rend()));
  } catch (const CLI::ParseError& error) {
    throw UsageError(fmt::format("--options: {}", error.what()));
  }
  for (const char* name : own)
    if (command.count(name) > 0)
      throw UsageError(fmt::format("--options: leave out {}, which the script sets", name));
  if (!scene.empty())
    throw UsageError("--options: '" + scene + "' is not an option; give scenes before --options");
}

RenderArguments checked_render_options(const std::vector<std::string>& words) {
  RenderArguments arguments;
  CLI::App render;
  add_render_options(render, arguments);
  read_options(render, words,
               {"--output", "--part", "--resume", "--threads", "--camera", "--stats"},
               arguments.options.scene);
  return arguments;
}

/// Checks the sweep whole, run by run. @throws UsageError, InputError, FileError
void check_sweep(const SubmitArguments& submit, const std::vector<std::string>& words, int parts) {
  if (submit.scenes.size() > 1)
    throw UsageError("--sweep takes one scene, not " + std::to_string(submit.scenes.size()));
  SweepArguments arguments;
  CLI::App sweep{"", "sweep"};
  std::vector<FileOption> file;
  add_sweep_options(sweep, arguments, file);
  for (const char* name : {"SCENE", "--output"}) sweep.get_option(name)->required(false);
  read_options(sweep, words, {"--output", "--part", "--threads"}, arguments.render.options.scene);
  arguments.render.options.scene = submit.scenes.front();
  arguments.output = submit.sweep;
  const SweepPlan plan = plan_sweep(arguments, {});
  if (static_cast<int>(plan.runs.size()) < parts)
    throw UsageError(
        fmt::format("--parts: there are {} runs, fewer than {}", plan.runs.size(), parts));
}

/// Checks what can be checked of a matrix without following rays. @throws UsageError, InputError,
/// FileError
void check_matrix(const SubmitArguments& submit, const std::vector<std::string>& words) {
  if (submit.scenes.size() > 1)
    throw UsageError("--operator takes one scene, not " + std::to_string(submit.scenes.size()));
  check_ending("--operator", submit.matrix, {".npz", ".h5"});
  OperatorArguments arguments;
  CLI::App matrix{"", "operator"};
  std::vector<FileOption> file;
  add_operator_options(matrix, arguments, file);
  for (const char* name : {"SCENE", "--output"}) matrix.get_option(name)->required(false);
  read_options(matrix, words, {"--output", "--part", "--threads", "--pixels", "--places", "--json"},
               arguments.scene);
  check_operator(arguments);
  static_cast<void>(read_camera_scenes(submit.scenes, arguments.set, arguments.cameras));
}

std::vector<SubmittedPicture> pictures_of(const SubmitArguments& arguments,
                                          const RenderArguments& render) {
  std::vector<SubmittedPicture> pictures;
  std::set<std::string> names;
  for (const std::string& scene : arguments.scenes) {
    RenderArguments one = render;
    one.options.scene = scene;
    static_cast<void>(checked_options(one));
    const SceneDocument document = read_valid_scene(scene, render.options.set);
    const std::string stem = std::filesystem::path(scene).stem().string();
    const bool several = !document.scene.cameras.empty();
    for (const CameraScene& camera : choose_cameras(document, scene, {})) {
      const std::string& name = camera.document.scene.camera.name;
      pictures.push_back({scene, several ? name : "", several ? stem + "-" + name : stem});
      if (!names.insert(pictures.back().whole).second)
        throw UsageError(fmt::format("two pictures would be called {}.exr: rename a scene",
                                     pictures.back().whole));
    }
  }
  return pictures;
}

/// "1-02:03:04", the format of sbatch.
std::string slurm_time(const std::string& text) {
  const double seconds = duration_option("--time", text);
  constexpr double kMost = 365 * 86400.0;
  if (!(seconds >= 1 && seconds <= kMost))
    throw UsageError("--time: from 1 s to a year, not '" + text + "'");
  const auto whole = static_cast<long long>(std::ceil(seconds));
  return fmt::format("{}-{:02}:{:02}:{:02}", whole / 86400, whole / 3600 % 24, whole / 60 % 60,
                     whole % 60);
}

std::string header(const SubmitArguments& arguments, const JobArray& job, std::size_t pictures) {
  std::string text = fmt::format(
      "#!/bin/sh\n#SBATCH --job-name={0}\n#SBATCH --array=1-{1}\n#SBATCH --ntasks=1\n"
      "#SBATCH --cpus-per-task={2}\n#SBATCH --output={0}-%a.log\n",
      job.name, pictures * static_cast<std::size_t>(job.parts), job.threads);
  if (!arguments.time.empty())
    text += fmt::format("#SBATCH --time={}\n", slurm_time(arguments.time));
  if (!arguments.memory.empty()) text += fmt::format("#SBATCH --mem={}\n", arguments.memory);
  if (!arguments.partition.empty())
    text += fmt::format("#SBATCH --partition={}\n", arguments.partition);
  return text;
}

constexpr const char* kBegin = "set -eu\ncommand=${PLENOFLAME:-plenoflame}\n";
constexpr const char* kTask =
    "task=${SLURM_ARRAY_TASK_ID:?is not set: submit this script with sbatch}\n";

constexpr const char* kIsThere =
    "if [ -e \"$file\" ]; then\n  echo \"$file is done\"\n  exit 0\nfi\n";

std::string no_further_task(int parts) {
  return fmt::format(
      "if [ \"$task\" -gt {} ]; then\n  echo \"there is no task $task\" >&2\n  exit 2\nfi\n",
      parts);
}

std::string with_options(std::string text, const JobArray& job) {
  text += fmt::format(" --threads {} --quiet", job.threads);
  for (const std::string& option : job.options)
    if (option != "--quiet") text += ' ' + shell_word(option);
  return text + '\n';
}

/// The script of a sweep. A task of the array makes the runs of a part, or the remaining ones after
/// a restart.
std::string sweep_script(const SubmitArguments& arguments, const JobArray& job) {
  std::string folder = arguments.sweep;
  while (folder.size() > 1 && folder.back() == '/') folder.pop_back();
  folder = shell_word(folder);
  const int parts = job.parts;
  std::string text = header(arguments, job, 1) + kBegin;
  if (parts > 1)
    text += fmt::format(
        "if [ \"${{1:-}}\" = merge ]; then\n"
        "  exec \"$command\" merge {0}-part-*-of-{1} -o {0}\nfi\n",
        folder, parts);
  text += kTask;
  text += no_further_task(parts);
  text +=
      fmt::format("exec \"$command\" sweep {} -o {}", shell_word(arguments.scenes.front()), folder);
  if (parts > 1) text += fmt::format(" --part \"$task/{}\"", parts);
  return with_options(text, job);
}

/// The script of a matrix: a task of the array makes the rows of a part.
std::string matrix_script(const SubmitArguments& arguments, const JobArray& job) {
  const std::string scene = shell_word(arguments.scenes.front());
  const std::size_t dot = arguments.matrix.rfind('.');
  const std::string stem = shell_word(arguments.matrix.substr(0, dot)),
                    ending = arguments.matrix.substr(dot), whole = shell_word(arguments.matrix);
  const int parts = job.parts;
  std::string text = header(arguments, job, 1) + kBegin;
  if (parts > 1)
    text += fmt::format(
        "if [ \"${{1:-}}\" = merge ]; then\n"
        "  exec \"$command\" merge {0}-part-*-of-{1}{2} -o {3}\nfi\n",
        stem, parts, ending, whole);
  text += kTask;
  text += no_further_task(parts);
  text += parts > 1 ? fmt::format("file={}-part-$task-of-{}{}\n", stem, parts, ending)
                    : fmt::format("file={}\n", whole);
  text += kIsThere;
  text += fmt::format("exec \"$command\" operator {} -o \"$file\"", scene);
  if (parts > 1) text += fmt::format(" --part \"$task/{}\"", parts);
  return with_options(text, job);
}

/// The script: a task of the array renders a part, and continues it after a restart.
std::string script(const SubmitArguments& arguments, const JobArray& job,
                   const std::vector<SubmittedPicture>& pictures, bool frames) {
  const int parts = job.parts;
  std::string text = header(arguments, job, pictures.size()) + kBegin;
  const std::string ending = parts > 1 ? fmt::format("-part-$part-of-{}", parts) : "";
  if (parts > 1) {
    text += "if [ \"${1:-}\" = merge ]; then\n";
    for (const SubmittedPicture& picture : pictures) {
      const std::string first = fmt::format("-part-1-of-{}.exr", parts);
      text += fmt::format(
          "  for first in {0}{1}{2}; do\n    whole=${{first%{2}}}\n"
          "    \"$command\" merge \"$whole\"-part-*-of-{3}.exr -o \"$whole.exr\"\n  done\n",
          shell_word(picture.whole), frames ? ".*" : "", first, parts);
    }
    text += "  exit 0\nfi\n";
  }
  text += kTask;
  if (parts > 1) text += fmt::format("part=$(( (task - 1) % {} + 1 ))\n", parts);
  text += fmt::format("case $(( (task - 1) / {} )) in\n", parts);
  for (std::size_t i = 0; i < pictures.size(); ++i)
    text +=
        fmt::format("  {}) set -- {}{}; whole={} ;;\n", i, shell_word(pictures[i].scene),
                    pictures[i].camera.empty() ? "" : " --camera " + shell_word(pictures[i].camera),
                    shell_word(pictures[i].whole));
  text += "  *) echo \"there is no task $task\" >&2; exit 2 ;;\nesac\n";
  std::string resume;
  if (frames) {
    resume = " --resume \"$whole.exr\"";
  } else {
    text += fmt::format(
        "file=$whole{0}.exr\nif [ -e \"$file.state\" ]; then\n"
        "  exec \"$command\" render --resume \"$file\" --threads {1} --quiet\nfi\n",
        ending, job.threads);
    text += kIsThere;
  }
  text += "exec \"$command\" render \"$@\" -o \"$whole.exr\"" + resume;
  if (parts > 1) text += fmt::format(" --part \"$part/{}\"", parts);
  return with_options(text, job);
}

/// Checks the pictures, and makes their script. @throws UsageError, InputError, FileError
std::string picture_script(const SubmitArguments& arguments, const JobArray& job) {
  const RenderArguments render = checked_render_options(job.options);
  const std::vector<SubmittedPicture> pictures = pictures_of(arguments, render);
  RenderArguments one = render;
  one.options.scene = arguments.scenes.front();
  one.part = job.parts > 1 ? fmt::format("1/{}", job.parts) : "";
  static_cast<void>(checked_options(one));
  return script(arguments, job, pictures, !render.frames.empty());
}

int run_submit(const SubmitArguments& arguments) {
  if (!arguments.slurm) throw UsageError("the batch system is missing; give --slurm");
  for (const auto& [option, text] :
       {std::pair{"--memory", arguments.memory}, std::pair{"--partition", arguments.partition}})
    if (text.find_first_of(" \t\n") != std::string::npos)
      throw UsageError(fmt::format("{}: '{}' has blanks", option, text));
  // sbatch takes a plain number for megabytes.
  if (!arguments.memory.empty() &&
      std::string_view("KMGT").find(arguments.memory.back()) == std::string_view::npos)
    throw UsageError("--memory needs a unit, K, M, G or T, e.g. 4G, not '" + arguments.memory +
                     "'");
  JobArray job;
  job.options = words_of(arguments.options);
  job.parts = whole_number_option("--parts", arguments.parts, 1, kMostParts);
  job.threads = whole_number_option("--threads", arguments.threads, 1, 4096);
  job.name = std::filesystem::path(arguments.output).stem().string();
  for (char& c : job.name)
    if (c == ' ' || c == '%') c = '_';
  if (!arguments.sweep.empty()) {
    check_sweep(arguments, job.options, job.parts);
    write_file(arguments.output, sweep_script(arguments, job));
  } else if (!arguments.matrix.empty()) {
    check_matrix(arguments, job.options);
    write_file(arguments.output, matrix_script(arguments, job));
  } else {
    write_file(arguments.output, picture_script(arguments, job));
  }
  const std::string file = shell_word(arguments.output);
  if (job.parts == 1)
    std::cout << fmt::format("sbatch {}\n", file);
  else
    std::cout << fmt::format(
        "job=$(sbatch --parsable {0})\nsbatch --dependency=afterok:$job --wrap \"sh {0} merge\"\n",
        file);
  return kSuccess;
}

}  // namespace

void register_submit(const Registry& registry) {
  const auto arguments = std::make_shared<SubmitArguments>();
  CLI::App& command = add_command(
      registry, "submit",
      "Write a batch script that computes pictures, a sweep or a matrix in parts",
      "plenoflame submit --slurm examples/paper-flame-1m.toml --parts 8 -o flame.sbatch");
  command.add_option("SCENE", arguments->scenes, "Scene files (.toml), one per picture")
      ->required();
  command.add_flag("--slurm", arguments->slurm,
                   "Slurm job array with one task per part of each picture, numbered from 1");
  add_option(
      command, "-o,--output", arguments->output, "FILE",
      "Script to write. Pictures are named after their scenes, in the folder of the submission")
      ->check(written())
      ->required();
  add_option(command, "--sweep", arguments->sweep, "DIR",
             "Sweep of the scene into this folder, in place of pictures");
  add_option(command, "--operator", arguments->matrix, "FILE",
             "Matrix of the scene to this file (.npz, .h5), in place of pictures")
      ->excludes("--sweep");
  add_option(command, "--parts", arguments->parts, "N",
             "Parts of each picture, sweep or matrix (1)");
  add_option(command, "--threads", arguments->threads, "N", "Processors of a task (1)");
  add_option(command, "--time", arguments->time, "TIME",
             "Time limit of a task, e.g. 2h or D-HH:MM:SS; without it, the batch system's default");
  add_option(command, "--memory", arguments->memory, "SIZE", "Memory of a task, e.g. 4G");
  add_option(command, "--partition", arguments->partition, "NAME", "Partition of the cluster");
  add_option(command, "--options", arguments->options, "TEXT",
             "Options for render, sweep or operator: --options '--samples 256 --truth'");
  on_chosen(command, registry, [arguments] { return run_submit(*arguments); });
}

}  // namespace plenoflame::cli
