// Builds the operator from voxels to pixels once, and reconstructs the emission of pictures with
// it.
//   reconstruct SCENE.toml FIELD.exr ...
#include <cstdio>

#include "plenoflame/inverse/emission_operator.h"
#include "plenoflame/inverse/reconstruction.h"

using namespace plenoflame;

int main(int count, char** arguments) try {
  if (count < 3) return std::fprintf(stderr, "usage: reconstruct SCENE.toml FIELD.exr ...\n"), 2;
  const CompiledScene scene = compile(read_scene_file(arguments[1]).scene);
  const Box box = scene.medium->bounds();
  const auto voxels = make_voxel_unknowns(
      regular_lattice(0.5 * (box.lower + box.upper), box.upper - box.lower, {4, 8, 8}));
  ReconstructionSettings settings;
  settings.draws = settings.probes = 0;
  const CameraRays rays = draw_camera_rays({{&scene, {}}}, box, settings.rays);
  const CsrMatrix<float> a = make_emission_matrix({&rays, voxels.get()}, {});
  std::printf("%zu rows, %zu unknowns\n", a.rows(), a.columns());
  for (int k = 2; k < count; ++k) {
    const Measurement picture =
        take_measurement(read_light_field(arguments[k]), scene.scene, 0, 0.01);
    ReconstructionInput input;
    input.views = {{&scene, {}}};
    input.measurements = {picture};
    input.unknowns = voxels.get();
    input.built = {&rays, &a};
    const Reconstruction found = reconstruct(input, settings);
    double explained = 0, measured = 0;
    for (const float flux : found.explained[0].pixels) explained += flux;
    for (const float flux : picture.flux.pixels) measured += flux;
    std::printf("explained %.4g W of %.4g W\n", explained, measured);
  }
  return 0;
} catch (const std::exception& error) {
  return std::fprintf(stderr, "reconstruct: %s\n", error.what()), 1;
}
