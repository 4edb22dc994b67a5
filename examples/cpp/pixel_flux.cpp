// The flux of a pixel from the stream of its rays, beside what the picture says.
//   pixel_flux SCENE.toml COLUMN ROW
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <vector>

#include "plenoflame/render/ray_stream.h"
#include "plenoflame/scene/scene_file.h"

using namespace plenoflame;

int main(int count, char** arguments) try {
  if (count != 4) return std::fprintf(stderr, "usage: pixel_flux SCENE.toml COLUMN ROW\n"), 2;
  const int column = std::atoi(arguments[2]), row = std::atoi(arguments[3]);
  const CompiledScene scene = compile(read_scene_file(arguments[1]).scene);

  RenderSettings settings;
  settings.window = {column - 2, row - 2, 5, 5};  // the pixel and its neighbours
  settings.precision = Precision::double_precision;

  // A consumer of its own: counts the rays of the pixel and adds up etendue * radiance.
  int rays = 0, ended = 0;
  double etendue = 0, flux = 0;
  const auto add = [&](const RayBlock<double>& block, int) {
    const Medium& flame = *block.scene->medium;
    const auto stride = static_cast<std::size_t>(block.rays.size);
    std::vector<double> radiance(stride * static_cast<std::size_t>(flame.channel_count()));
    std::vector<double> transmittance(stride);
    MediumCounters counters;
    flame.integrate(block.rays, {}, {radiance.data(), block.rays.size, transmittance.data()},
                    counters);
    for (std::size_t i = 0; i < block.etendue.size(); ++i) {
      if (block.columns[i] != column || block.rows[i] != row) continue;
      rays += 1;
      ended += block.status[i].status == RayStatus::reached ? 0 : 1;
      etendue += block.etendue[i];
      flux += block.etendue[i] * radiance[i];  // of the first channel
    }
  };
  stream_rays<double>(scene, settings, {}, add);
  std::printf("%d rays, of which %d end in the camera; etendue %.4g m^2 sr\n", rays, ended,
              etendue);

  const Image picture = render(scene, settings).light_field.channels.front().flux;
  std::printf("streamed %.6g W\npicture  %.6g W\n", flux, static_cast<double>(picture.at(2, 2)));
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "pixel_flux: %s\n", error.what());
  return 1;
}
