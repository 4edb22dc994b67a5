#include "plenoflame/inverse/camera_rays.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "plenoflame/base/error.h"
#include "plenoflame/render/ray_stream.h"
#include "plenoflame/scene/pupil_transmission.h"

namespace plenoflame {
namespace {

struct DrawnRay {
  std::size_t block;
  CameraRay ray;
};

bool meets(const Box& box, const CameraRay& ray) {
  double from = 0, to = ray.end;
  const auto clip = [&](double lower, double upper, double o, double d) {
    if (d == 0) {
      if (o < lower || o > upper) to = -1;
      return;
    }
    from = std::max(from, std::min((lower - o) / d, (upper - o) / d));
    to = std::min(to, std::max((lower - o) / d, (upper - o) / d));
  };
  clip(box.lower.x, box.upper.x, ray.origin.x, ray.direction.x);
  clip(box.lower.y, box.upper.y, ray.origin.y, ray.direction.y);
  clip(box.lower.z, box.upper.z, ray.origin.z, ray.direction.z);
  return to > from;
}

/// Weight in a channel of light that goes one way through the camera, and one part of its stop.
class RayShares {
 public:
  RayShares(const CompiledScene& scene, std::size_t channel)
      : transmission_(pupil_transmission(scene.scene, channel)) {
    for (const CompiledScene& path : scene.paths()) {
      const auto& of_path = path.film_channel;
      const bool has_all = of_path.empty();  // the only path
      std::vector<char> shows(transmission_.size(), has_all ? 1 : 0);
      if (std::find(of_path.begin(), of_path.end(), static_cast<int>(channel)) != of_path.end())
        for (std::size_t p = 0; p < shows.size(); ++p)
          shows[p] = path.part_mixes.empty() || path.part_mixes[p].weight(0, 0) > 0;
      shown_.push_back(std::move(shows));
    }
  }

  /// If glasses disperse, all wavelengths that stand for the channel behind the part count
  /// alike.
  double of(int path, int part) const {
    const auto p = static_cast<std::size_t>(part);
    if (!shown_[static_cast<std::size_t>(path)][p]) return 0;
    const auto ways = std::count_if(shown_.begin(), shown_.end(),
                                    [p](const std::vector<char>& shows) { return shows[p] != 0; });
    return transmission_[p] / static_cast<double>(ways);
  }

 private:
  std::vector<double> transmission_;      ///< of each part of the stop
  std::vector<std::vector<char>> shown_;  ///< of each spectral path, by part
};

/// Blocks of pixels of one camera.
struct Blocks {
  PixelWindow window;
  int bin, across, down;
  std::size_t count() const {
    return static_cast<std::size_t>(across) * static_cast<std::size_t>(down);
  }
  /// Index of a pixel on the whole sensor; count() for one that belongs to none.
  std::size_t of(int column, int row) const {
    const int i = (column - window.x) / bin, j = (row - window.y) / bin;
    if (i >= across || j >= down) return count();
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(across) +
           static_cast<std::size_t>(i);
  }
};

/// The rays that a compiled camera keeps, tile by tile.
std::vector<std::vector<DrawnRay>> unpack(const CameraView& view, const Blocks& blocks,
                                          const Box& box, int channel, const Execution& execution) {
  const CompiledCamera& camera = *view.compiled;
  const RayShares shares(*view.scene, static_cast<std::size_t>(channel));
  const Vec3 middle = 0.5 * (box.lower + box.upper);
  const double reach = length(box.upper - box.lower);
  std::vector<std::vector<DrawnRay>> tiles(camera.tiles.size());
  const auto task = [&](std::size_t t, int) {
    for (const CompiledRay& kept : rays_of_tile(*view.scene, camera, t, view.compiled_name)) {
      if (kept.column < blocks.window.x || kept.row < blocks.window.y) continue;
      const std::size_t block = blocks.of(kept.column, kept.row);
      const double share = shares.of(kept.path, kept.part);
      if (!(share * kept.weight > 0) || block >= blocks.count()) continue;
      CameraRay ray;
      ray.direction = kept.direction;
      // Lines begin in front of the box: compiled cameras see nothing else.
      ray.origin = kept.place - (dot(kept.place - middle, kept.direction) + reach) * kept.direction;
      ray.weight = share * kept.weight;
      ray.end = std::numeric_limits<double>::infinity();
      ray.replicate = kept.set;
      ray.part = kept.part;
      if (meets(box, ray)) tiles[t].push_back({block, ray});
    }
  };
  if (!parallel_for(execution, camera.tiles.size(), task)) throw Cancelled();
  return tiles;
}

/// That a compiled camera belongs to the scene, and sees all of the box and of the window.
void check_view(const CameraView& view, const PixelWindow& window, const Box& box) {
  check_compiled(*view.scene, *view.compiled, view.compiled_name);
  check_compiled_window(*view.compiled, window, view.compiled_name);
  check_region(*view.compiled, box, "the grid of the unknowns", view.compiled_name);
}

/// Rays of one camera, tile by tile: an order that does not depend on threads.
std::vector<std::vector<DrawnRay>> draw(const CompiledScene& scene, const Blocks& blocks,
                                        const Box& box, const CameraRaySettings& settings,
                                        const Execution& execution) {
  RenderSettings render;
  render.samples = settings.samples;
  render.replicates = settings.replicates;
  render.seed = settings.seed;
  render.window = blocks.window;
  const RayShares shares(scene, static_cast<std::size_t>(settings.channel));
  const int across = (blocks.window.width + Film::kTile - 1) / Film::kTile;
  const int down = (blocks.window.height + Film::kTile - 1) / Film::kTile;
  std::vector<std::vector<DrawnRay>> tiles(static_cast<std::size_t>(across) *
                                           static_cast<std::size_t>(down));
  const auto keep = [&](const RayBlock<double>& rays, int) {
    auto& tile = tiles[static_cast<std::size_t>(rays.tile)];
    for (std::size_t i = 0; i < static_cast<std::size_t>(rays.size); ++i) {
      const std::size_t block = blocks.of(rays.columns[i], rays.rows[i]);
      const int part = rays.pupil_parts.empty() ? 0 : rays.pupil_parts[i];
      const double share = shares.of(rays.path, part);
      if (!(share * rays.etendue[i] > 0) || block >= blocks.count()) continue;
      CameraRay ray;
      ray.part = part;
      ray.direction = {rays.rays.dx[i], rays.rays.dy[i], rays.rays.dz[i]};
      ray.origin = rays.rays.anchor + Vec3{rays.rays.x[i], rays.rays.y[i], rays.rays.z[i]} +
                   rays.rays.t_near[i] * ray.direction;
      ray.weight = share * rays.etendue[i];
      ray.end = rays.rays.t_far[i] - rays.rays.t_near[i];
      ray.replicate = rays.replicates[i];
      if (meets(box, ray)) tile.push_back({block, ray});
    }
  };
  if (!stream_rays<double>(scene, render, execution, keep, RayStreamContent::rays, {box}))
    throw Cancelled();
  return tiles;
}

}  // namespace

PixelWindow window_of(const CameraView& view) {
  if (view.window.width != 0) return view.window;
  if (view.compiled) return view.compiled->window;
  const SensorSpec& sensor = view.scene->scene.camera.sensor;
  return {0, 0, sensor.columns, sensor.rows};
}

CameraRays draw_camera_rays(const std::vector<CameraView>& views, const Box& box,
                            const CameraRaySettings& settings, const Execution& execution) {
  if (settings.bin < 1) throw UsageError("blocks of pixels must be at least one pixel wide");
  CameraRays result;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const PixelWindow window = window_of(views[v]);
    const CompiledCamera* const compiled = views[v].compiled;
    if (compiled) check_view(views[v], window, box);
    const Blocks blocks{window, settings.bin, window.width / settings.bin,
                        window.height / settings.bin};
    auto groups = compiled ? unpack(views[v], blocks, box, settings.channel, execution)
                           : draw(*views[v].scene, blocks, box, settings, execution);
    // By block, and within a block in the order of the groups.
    std::vector<std::size_t> begin(blocks.count() + 1, 0);
    for (const auto& group : groups)
      for (const DrawnRay& drawn : group) ++begin[drawn.block + 1];
    for (std::size_t b = 0; b < blocks.count(); ++b) {
      if (begin[b + 1] > 0)
        result.rows.push_back(
            {static_cast<int>(v),
             window.x + static_cast<int>(b % static_cast<std::size_t>(blocks.across)) * blocks.bin,
             window.y + static_cast<int>(b / static_cast<std::size_t>(blocks.across)) * blocks.bin,
             result.rays.size() + begin[b]});
      begin[b + 1] += begin[b];
    }
    const std::size_t first = result.rays.size();
    result.rays.resize(first + begin.back());
    // Each group gives back its memory as soon as it is copied.
    for (auto& group : groups) {
      for (const DrawnRay& drawn : group) result.rays[first + begin[drawn.block]++] = drawn.ray;
      group = {};
    }
  }
  return result;
}

}  // namespace plenoflame
