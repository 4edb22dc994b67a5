// Renders a scene and writes its light field.
//   render SCENE.toml FIELD.exr
#include <cstdio>

#include "plenoflame/render/describe.h"
#include "plenoflame/render/render_request.h"
#include "plenoflame/volumes/load_medium.h"

using namespace plenoflame;

int main(int count, char** arguments) try {
  if (count != 3) return std::fprintf(stderr, "usage: render SCENE.toml FIELD.exr\n"), 2;
  const CompiledScene scene = compile_scene(read_scene_file(arguments[1]));
  RenderResult result = render(scene, render_settings(scene.scene));
  describe(scene, result.light_field);
  write_light_field(arguments[2], result.light_field);
  std::printf("%.6g W\n", result.statistics.flux);
  return 0;
} catch (const std::exception& error) {
  return std::fprintf(stderr, "render: %s\n", error.what()), 1;
}
