// Stated deviations against errors for scenes of the size that users have, for the section of
// docs/validation.md: prints a row of its table for each.
//   pulls_of_examples SCENE UNKNOWNS GRID BIN RAYS SAMPLES RUNS NOISE CAMERA...
// UNKNOWNS, GRID, BIN, RAYS and NOISE: as `plenoflame reconstruct` has them, with the absorption of
// the scene; SAMPLES of the pictures; without CAMERA the first one.
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <exception>
#include <string>

#include "plenoflame/inverse/measurement.h"
#include "plenoflame/scene/cameras.h"
#include "plenoflame/volumes/load_medium.h"
#include "statistical/pulls.h"
#include "unknowns_request.h"

namespace plenoflame::test {
namespace {

void look_at(char** words, int count) {
  const std::string path = words[0];
  const auto number = [&](int i) { return std::atoi(words[i]); };
  const SceneDocument document = read_scene_file(path);
  std::vector<std::string> names(words + 8, words + count);
  if (names.empty()) names = {camera_names(document.scene).front()};
  std::deque<CompiledScene> scenes;
  PullExperiment how;
  for (const std::string& name : names) {
    scenes.push_back(compile(for_camera(document.scene, name), load_medium));
    how.cameras.push_back(&scenes.back());
  }
  const CompiledScene& scene = scenes.front();
  UnknownsRequest request;
  request.kind = words[1];
  request.grid = words[2];
  request.absorption = "scene";
  const auto unknowns = unknowns_of(request, scene);
  how.unknowns = unknowns.get();
  how.absorption = absorption_of(request, scene, 0, *unknowns);
  const SourceFunction source = channel_source(scene.scene, 0);
  for (std::size_t j = 0; j < unknowns->size(); ++j)
    how.truth.push_back(
        how.absorption[j] > 0 ? source(flame_at(scene, 0, unknowns->place(j)).temperature) : 0);
  how.settings.rays.bin = number(3);
  how.settings.rays.samples = number(4);
  how.settings.memory = 8e9;
  how.settings.draws = 32;
  how.samples = number(5);
  how.runs = number(6);
  how.model_error = std::atof(words[7]);
  const Pulls pulls = measure_pulls(how);
  std::printf("| %s | %zu | %s | %.2f | %.2f | %.1f | %zu of %zu | %.2f | %.1f | %.1f %% |\n",
              path.c_str(), unknowns->size(), words[7], pulls.chi_squared, pulls.scatter,
              pulls.typical_bias, pulls.small, pulls.bright, pulls.unbiased, pulls.all,
              100 * pulls.error);
}

}  // namespace
}  // namespace plenoflame::test

int main(int count, char** arguments) {
  if (count < 9) return 2;
  try {
    plenoflame::test::look_at(arguments + 1, count - 1);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "pulls_of_examples: %s\n", error.what());
    return 1;
  }
  return 0;
}
