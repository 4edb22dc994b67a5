// Reconstructs the flame of a scene from a picture of it.
//   reconstruct SCENE.toml FIELD.exr FLAME.vdb
#include <cstdio>

#include "plenoflame/volumes/load_medium.h"
#include "plenoflame/volumes/reconstructor.h"

using namespace plenoflame;

int main(int count, char** arguments) try {
  if (count != 4) return std::fprintf(stderr, "usage: reconstruct SCENE FIELD FLAME.vdb\n"), 2;
  const auto scene =
      std::make_shared<const CompiledScene>(compile_scene(read_scene_file(arguments[1])));
  ReconstructRequest request;
  request.unknowns.grid = {4, 8, 8};
  request.noise = 0.01;
  const auto found = reconstruct_flame(request, {{scene, read_light_field(arguments[2])}});
  write_estimate(arguments[3], found->result, found->unknowns());
  std::fputs(found->report.text().c_str(), stdout);
  return 0;
} catch (const std::exception& error) {
  return std::fprintf(stderr, "reconstruct: %s\n", error.what()), 1;
}
