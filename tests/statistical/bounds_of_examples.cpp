// The share of pictures in which the stated bound of the error holds: over many seeds, in every
// example. Prints lines
//   coverage | scene | window | samples | replicates | seeds | share | median of bound over error
//   left out | scene | window | samples | replicates | reason
// from which tests/stress/write_numerics.py makes a table of docs/numerics.md. The columns between
// scene and reason are "-" where no picture could be made.
//   bounds_of_examples PATH [SECONDS]   PATH: a scene, or the folder of the examples with their
//                                       flames; SECONDS of a row, at most
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "plenoflame/render/render.h"
#include "plenoflame/scene/cameras.h"
#include "plenoflame/volumes/load_medium.h"
#include "statistical/measured_errors.h"

namespace plenoflame::test {
namespace {

constexpr int kMostSeeds = 200, kLeastRuns = 40;
constexpr double kReferenceFactor = 64;  // a reference takes so many runs' samples

struct Way {
  int samples, replicates;
};
constexpr Way kWays[] = {{16, 2}, {16, 4}, {128, 2}, {128, 4}};

Execution one() {
  Execution execution;
  execution.threads = 1;
  return execution;
}

/// The brightest window of a side in a picture of few samples: what a user looks at.
PixelWindow brightest(const CompiledScene& scene, int side) {
  RenderSettings settings;
  settings.samples = 2;
  const Image flux = render(scene, settings, one()).light_field.channels[0].flux;
  side = std::min({side, flux.width, flux.height});
  PixelWindow best{0, 0, side, side};
  double most = -1;
  for (int y = 0; y + side <= flux.height; y += side)
    for (int x = 0; x + side <= flux.width; x += side) {
      double sum = 0;
      for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i) sum += static_cast<double>(flux.at(x + i, y + j));
      if (sum > most) {
        most = sum;
        best = {x, y, side, side};
      }
    }
  return best;
}

/// Time of the processor: the number of pictures shall not depend on what else the machine does.
double seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

void leave_out(const std::string& name, const std::string& row, const std::string& reason) {
  std::printf("left out | %s | %s | %s\n", name.c_str(), row.c_str(), reason.c_str());
  std::fflush(stdout);
}

void look(const CompiledScene& scene, const std::string& name, const PixelWindow& window,
          const Way& way, double limit) {
  const std::string row = std::to_string(window.width) + " | " + std::to_string(way.samples) +
                          " | " + std::to_string(way.replicates);
  RenderSettings settings;
  settings.samples = way.samples;
  settings.replicates = way.replicates;
  settings.window = window;
  const double start = seconds();
  render(scene, settings, one());
  const double each = std::max(seconds() - start, 1e-6);
  if (each * (kLeastRuns + kReferenceFactor) > limit) {
    char reason[64];
    std::snprintf(reason, sizeof reason, "%.2g s a picture", each);
    return leave_out(name, row, reason);
  }
  const int seeds =
      static_cast<int>(std::min(static_cast<double>(kMostSeeds), limit / each - kReferenceFactor));
  const Truth truth(scene, settings, static_cast<int>(kReferenceFactor) * way.samples);
  int below = 0;
  std::vector<double> widths;
  for (int seed = 1; seed <= seeds; ++seed) {
    settings.seed = static_cast<std::uint64_t>(seed);
    const RenderResult run = render(scene, settings, one());
    const double error = truth.rmse_of(run.light_field.channels[0].flux);
    below += error <= run.statistics.relative_error_bound ? 1 : 0;
    if (error > 0) widths.push_back(run.statistics.relative_error_bound / error);
  }
  if (widths.empty()) return leave_out(name, row, "no light, or no error");
  std::printf("coverage | %s | %s | %d | %.3f | %.2f\n", name.c_str(), row.c_str(), seeds,
              static_cast<double>(below) / seeds, median(widths));
  std::fflush(stdout);
}

void look_at(const std::string& path, const std::string& file, double limit) {
  const SceneDocument document = read_scene_file(path);
  const std::string camera = camera_names(document.scene).front();  // the others see much the same
  const CompiledScene scene = compile(for_camera(document.scene, camera), load_medium, one());
  for (const int side : {48, 8}) {
    const PixelWindow window = brightest(scene, side);
    for (const Way& way : kWays) look(scene, file, window, way, limit);
  }
}

}  // namespace
}  // namespace plenoflame::test

int main(int count, char** arguments) {
  if (count < 2) return 2;
  namespace files = std::filesystem;
  std::vector<files::path> scenes;
  if (files::is_directory(arguments[1])) {
    for (const auto& entry : files::directory_iterator(arguments[1]))
      if (entry.path().extension() == ".toml") scenes.push_back(entry.path());
    std::sort(scenes.begin(), scenes.end());
  } else {
    scenes.emplace_back(arguments[1]);
  }
  const double limit = count > 2 ? std::atof(arguments[2]) : 20;
  for (const files::path& scene : scenes) {
    const std::string name = scene.stem().string();
    try {
      plenoflame::test::look_at(scene.string(), name, limit);
    } catch (const std::exception& error) {
      std::string reason = error.what();  // one line, without the columns' separator
      std::replace(reason.begin(), reason.end(), '\n', ' ');
      std::replace(reason.begin(), reason.end(), '|', '/');
      plenoflame::test::leave_out(name, "- | - | -", reason);
    }
  }
  return 0;
}
