#include "plenoflame/inverse/light_behind.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "plenoflame/base/error.h"
#include "plenoflame/base/part_of_progress.h"
#include "plenoflame/render/ray_stream.h"

namespace plenoflame {
namespace {

bool glows(const SurfaceScene& surfaces) {
  for (int s = 0; s < surfaces.surface_count(); ++s)
    if (surfaces.emission(s, true) || surfaces.emission(s, false)) return true;
  return false;
}

/// The row of each pixel of a window; -1: none.
class RowsOfPixels {
 public:
  RowsOfPixels(const CameraRays& rays, int view, const PixelWindow& window, int bin)
      : window_(window),
        row_(static_cast<std::size_t>(window.width) * static_cast<std::size_t>(window.height), -1) {
    for (std::size_t r = 0; r < rays.rows.size(); ++r) {
      if (rays.rows[r].view != view) continue;
      rays.for_each_pixel(r, bin, [&](int column, int row) {
        row_[index(column, row)] = static_cast<std::int64_t>(r);
      });
    }
  }
  std::int64_t at(int column, int row) const { return row_[index(column, row)]; }

 private:
  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row - window_.y) * static_cast<std::size_t>(window_.width) +
           static_cast<std::size_t>(column - window_.x);
  }
  PixelWindow window_;
  std::vector<std::int64_t> row_;
};

double transmittance(const Unknowns& unknowns, const std::vector<double>& absorption,
                     const Ray& ray, double t_far, RayIntervals& intervals) {
  if (absorption.empty()) return 1;
  intervals.clear();
  unknowns.append(ray, 0, t_far, intervals);
  double depth = 0;
  for (const RayInterval& interval : intervals)
    depth += 0.5 * interval.length *
             (value_at(interval, 0, absorption) + value_at(interval, 1, absorption));
  return std::exp(-depth);
}

/// Number of a channel of the whole scene among those of a block's path; -1: it has none of it.
int channel_of(const RayBlock<double>& block, int channel) {
  for (std::size_t c = 0; c < block.scene->scene.channels.size(); ++c)
    if (block.channel_of_scene(c) == static_cast<std::size_t>(channel)) return static_cast<int>(c);
  return -1;
}

}  // namespace

bool shines_without_flames(const CompiledScene& scene) {
  return std::any_of(scene.paths().begin(), scene.paths().end(), [](const CompiledScene& path) {
    return !path.lights.empty() || (path.surfaces && glows(*path.surfaces));
  });
}

std::vector<double> light_behind(const std::vector<CameraView>& views, const CameraRays& rays,
                                 const Unknowns& unknowns, const std::vector<double>& absorption,
                                 const CameraRaySettings& settings, const Execution& execution) {
  std::vector<double> light;
  const Execution quiet = without_reports(execution);
  for (std::size_t v = 0; v < views.size(); ++v) {
    const CompiledScene& scene = *views[v].scene;
    if (!shines_without_flames(scene)) continue;
    light.resize(rays.rows.size(), 0.0);
    Scene dark = scene.scene;
    dark.flames.clear();
    const CompiledScene without = compile(dark, load_core_medium, quiet, {}, {&scene});
    RenderSettings render;
    render.samples = settings.samples;
    render.replicates = settings.replicates;
    render.seed = settings.seed;
    render.window = views[v].window;
    if (render.window.width == 0)
      render.window = {0, 0, dark.camera.sensor.columns, dark.camera.sensor.rows};
    render.skip = false;  // surroundings are seen by every pixel
    const RowsOfPixels row_of(rays, static_cast<int>(v), render.window, settings.bin);
    // Sums of each tile, whose blocks come in their order.
    std::vector<std::vector<std::pair<std::size_t, double>>> tiles;
    const int across = (render.window.width + Film::kTile - 1) / Film::kTile;
    const int down = (render.window.height + Film::kTile - 1) / Film::kTile;
    tiles.resize(static_cast<std::size_t>(across) * static_cast<std::size_t>(down));
    const auto add = [&](const RayBlock<double>& block, int) {
      const int channel = channel_of(block, settings.channel);
      if (channel < 0) return;
      auto& tile = tiles[static_cast<std::size_t>(block.tile)];
      RayIntervals intervals;
      const double* const radiance =
          block.radiance.data() + static_cast<std::ptrdiff_t>(channel) * block.rays.size;
      for (std::size_t i = 0; i < static_cast<std::size_t>(block.size); ++i) {
        const std::int64_t row = row_of.at(block.columns[i], block.rows[i]);
        const double flux = block.etendue[i] * radiance[i];
        if (row < 0 || !(flux > 0)) continue;
        const Vec3 direction{block.rays.dx[i], block.rays.dy[i], block.rays.dz[i]};
        const Vec3 origin = block.rays.anchor +
                            Vec3{block.rays.x[i], block.rays.y[i], block.rays.z[i]} +
                            block.rays.t_near[i] * direction;
        const double passed = transmittance(unknowns, absorption, {origin, direction},
                                            block.rays.t_far[i] - block.rays.t_near[i], intervals);
        if (!tile.empty() && tile.back().first == static_cast<std::size_t>(row))
          tile.back().second += flux * passed;
        else
          tile.push_back({static_cast<std::size_t>(row), flux * passed});
      }
    };
    if (!stream_rays<double>(without, render, quiet, add, RayStreamContent::radiance))
      throw Cancelled();
    for (const auto& tile : tiles)
      for (const auto& [row, flux] : tile) light[row] += flux;
  }
  return light;
}

void take_away(const std::vector<double>& light, MeasuredRows& measured) {
  for (std::size_t i = 0; i < light.size(); ++i) {
    measured.flux[i] -= light[i];
    measured.counted[i] -= light[i];
  }
}

}  // namespace plenoflame
