// The linear operator of a reconstruction: the flux of each pixel as a weighted sum over voxels.
//   ray_voxels SCENE.toml COLUMN ROW    the camera and the flame's place are the scene's
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>

#include "plenoflame/media/voxel_medium.h"
#include "plenoflame/render/ray_stream.h"
#include "plenoflame/scene/scene_file.h"

using namespace plenoflame;

constexpr double h = 4e-3;  // [m] side of a voxel

/// 8 x 8 x 8 voxels around a place: base + v % period each.
VoxelField brick(Vec3 centre, float background, int base, int period) {
  const Vec3 first = centre - Vec3{3.5 * h, 3.5 * h, 3.5 * h};
  const AffineTransform to_world{{{{{h, 0, 0}, {0, h, 0}, {0, 0, h}}}}, first};
  VoxelField field{{{0, 0, 0}}, {}, background, to_world, "example"};
  for (int v = 0; v < 512; ++v) field.values.push_back(static_cast<float>(base + v % period));
  return field;
}

int main(int count, char** arguments) {
  if (count != 4) return 2;
  CompiledScene scene = compile(read_scene_file(arguments[1]).scene);
  const Vec3 centre = 0.5 * (scene.medium->bounds().lower + scene.medium->bounds().upper);
  const VoxelField hot = brick(centre, 300, 1500, 97);
  scene.medium = make_voxel_medium(hot, brick(centre, 0, 5, 13), VoxelInterpolation::constant,
                                   {SourceFunction::total()});
  RenderSettings settings;
  settings.window = {std::atoi(arguments[2]), std::atoi(arguments[3]), 16, 16};
  settings.precision = Precision::double_precision;
  std::vector<std::map<long, double>> rows(256);  // of each pixel: voxel, weight [m^2 sr]
  stream_rays<double>(scene, settings, {}, [&](const RayBlock<double>& block, int) {
    const RayBatch<double>& r = block.rays;
    for (int i = 0; i < block.size; ++i) {
      const Ray ray{r.anchor + Vec3{r.x[i], r.y[i], r.z[i]}, {r.dx[i], r.dy[i], r.dz[i]}};
      std::vector<double> t{r.t_near[i]};
      scene.medium->append_breakpoints(ray, t);  // where the ray meets faces of voxels
      std::sort(t.begin(), t.end());
      double weight = block.etendue[i];  // of radiance that enters the stretch from behind
      auto& row =
          rows[(block.rows[i] - settings.window.y) * 16 + block.columns[i] - settings.window.x];
      for (std::size_t k = 1; k < t.size(); ++k) {
        const Vec3 at = ray.origin + 0.5 * (t[k - 1] + t[k]) * ray.direction;
        const double passes = std::exp(-scene.medium->sample(at).absorption * (t[k] - t[k - 1]));
        const Vec3 v = (1 / h) * (at - hot.index_to_world.translation);
        const long number = std::lround(v.x) * 64 + std::lround(v.y) * 8 + std::lround(v.z);
        if (passes < 1) row[number] += weight * (1 - passes);
        weight *= passes;
      }
    }
  });
  const Image picture = render(scene, settings).light_field.channels.front().flux;
  double worst = 0;
  const float brightest = *std::max_element(picture.pixels.begin(), picture.pixels.end());
  for (std::size_t p = 0; p < rows.size(); ++p) {
    double flux = 0;  // the row times the voxels' source function
    for (const auto& [v, weight] : rows[p]) flux += weight * scene.medium->source(0, hot.values[v]);
    worst = std::max(worst, std::fabs(flux - picture.pixels[p]));
  }
  std::printf("farthest from the picture: %.1g of %.3g W\n", worst / brightest, brightest);
}
