#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "plenoflame/base/error.h"
#include "plenoflame/base/mended_by.h"
#include "plenoflame/base/version.h"
#include "plenoflame/render/compiled_camera.h"
#include "plenoflame/render/ray_stream.h"
#include "render/compiled/bundle_file.h"
#include "render/compiled/compiled_frame.h"
#include "render/compiled/tile_bundles.h"
#include "render/run/check_settings.h"

namespace plenoflame {
namespace {

/// Number of rays per polynomial from which a set draws its few rays. The moments are those of all
/// rays.
constexpr std::size_t kWalked = 8;

/// Relative RMSE over lit pixels of pictures of a layered flame, measured with
/// examples/paper-flame-1m.toml (docs/theory/compiled.md). Smoother flames have smaller errors.
struct Closeness {
  double error;
  int level, samples;
};
constexpr Closeness kCloseness[] = {{0.045, 1, 64},   {0.022, 2, 256},   {0.012, 3, 512},
                                    {0.0065, 4, 512}, {0.0036, 5, 1024}, {0.002, 6, 2048},
                                    {0.0011, 7, 4096}};

Closeness closeness_of(const CompileSettings& settings) {
  if (!(settings.error > 0)) throw UsageError("the error of a compiled camera must be above 0");
  Closeness chosen = kCloseness[std::size(kCloseness) - 1];
  for (const Closeness& c : kCloseness)
    if (c.error <= settings.error) {
      chosen = c;
      break;
    }
  if (settings.level > 0) chosen.level = std::min(settings.level, kCompileLevels);
  if (settings.samples > 0) chosen.samples = settings.samples;
  return chosen;
}

Box grown(const Box& box, double margin) {
  const Vec3 more{margin, margin, margin};
  return {box.lower - more, box.upper + more};
}

Box region_of(const CompiledScene& scene, const CompileSettings& settings) {
  if (!settings.region.empty()) return grown(settings.region, settings.margin);
  Box box;
  if (scene.medium)
    for (const Box& part : scene.medium->occupied()) {
      if (part.empty()) continue;
      if (box.empty()) box = part;
      box.lower = {std::min(box.lower.x, part.lower.x), std::min(box.lower.y, part.lower.y),
                   std::min(box.lower.z, part.lower.z)};
      box.upper = {std::max(box.upper.x, part.upper.x), std::max(box.upper.y, part.upper.y),
                   std::max(box.upper.z, part.upper.z)};
    }
  if (box.empty())
    throw mended_by(InputError("the scene has no flame: say where later ones will be"), {"region"});
  return grown(box, settings.margin);
}

/// Rays are infinite lines, so a region behind the camera would be taken for visible.
void check_in_front(const CompiledScene& scene, const CompiledCamera& camera) {
  const Vec3 front = scene.camera.to_world().point({0, 0, 0});
  const double nearest = dot(camera.anchor - front, camera.along) - half_depth(camera);
  if (!(nearest > 0))
    throw mended_by(
        InputError(fmt::format(
            "the region begins {:.6g} m behind the front of the camera's lens: give one that lies "
            "in front of it",
            -nearest)),
        {"region", "margin"});
}

/// Moves the tiles' contents into the camera.
void keep(std::vector<CompiledContent> contents, CompiledCamera& camera) {
  for (const CompiledContent& content : contents) {
    CompiledTile tile;
    tile.first_group = camera.groups, tile.groups = content.groups.size();
    tile.first_node = camera.nodes, tile.nodes = content.nodes.size();
    tile.checksum = tile_checksum(content.groups, content.nodes);
    camera.groups += tile.groups, camera.nodes += tile.nodes;
    camera.tiles.push_back(tile);
  }
  camera.content = [kept = std::make_shared<const std::vector<CompiledContent>>(
                        std::move(contents))](std::size_t tile) { return kept->at(tile); };
}

/// Collects the rays of the workers; each worker has one tile at a time.
class Gathering {
 public:
  Gathering(const CompiledCamera& camera, const CompiledScene& scene, int threads)
      : tiles_(camera.window, 1, 1), done_(static_cast<std::size_t>(tiles_.tile_count())) {
    const int parts = std::max(1, static_cast<int>(scene.part_mixes.size()));
    const int paths = static_cast<int>(scene.paths().size());
    if (paths > std::numeric_limits<std::uint8_t>::max() ||
        parts > std::numeric_limits<std::uint8_t>::max())
      throw InputError(fmt::format(
          "a compiled camera has room for 255 wavelengths and 255 parts of the stop, not {} and {}",
          paths, parts));
    for (int worker = 0; worker < threads; ++worker)
      workers_.push_back({TileBundles(camera, paths, parts,
                                      BundleReducer(camera.level, half_depth(camera), kWalked)),
                          kNone});
  }
  void add(const RayBlock<float>& block, int worker) {
    Worker& own = workers_[static_cast<std::size_t>(worker)];
    if (own.tile != block.tile) {
      finish(own);
      own.tile = block.tile;
      own.bundles.begin(tiles_.tile(block.tile));
    }
    own.bundles.add(block);
  }
  std::vector<CompiledContent> take(const Execution& execution) {
    Execution quiet = execution.threads_only();
    parallel_for(quiet, workers_.size(), [&](std::size_t i, int) { finish(workers_[i]); });
    return std::move(done_);
  }

 private:
  static constexpr int kNone = -1;
  struct Worker {
    TileBundles bundles;
    int tile;
  };
  void finish(Worker& own) {
    if (own.tile != kNone) done_[static_cast<std::size_t>(own.tile)] = own.bundles.finish();
    own.tile = kNone;
  }
  Film tiles_;
  std::vector<CompiledContent> done_;
  std::vector<Worker> workers_;
};

}  // namespace

CompiledCamera compile_camera(const CompiledScene& scene, const CompileSettings& settings,
                              const Execution& execution) {
  check_content(scene);
  const Closeness close = closeness_of(settings);
  RenderSettings render;
  render.window = settings.window;
  render.samples = std::max(2, close.samples);
  render.replicates = 2;
  render.seed = settings.seed;
  render.skip = settings.skip;
  const SensorSpec& sensor = scene.scene.camera.sensor;
  check_settings(render, sensor);
  CompiledCamera camera;
  camera.version = version();
  camera.key = compiled_key(scene);
  camera.window = window_of(render, sensor);
  camera.sensor_width = sensor.columns;
  camera.sensor_height = sensor.rows;
  camera.region = region_of(scene, settings);
  camera.error = settings.error;
  camera.samples = render.samples;
  camera.level = close.level;
  camera.seed = settings.seed;
  place_frame(scene, camera);
  check_in_front(scene, camera);
  Gathering gathering(camera, scene, execution.thread_count());
  if (!stream_rays<float>(
          scene, render, execution,
          [&](const RayBlock<float>& block, int worker) { gathering.add(block, worker); },
          RayStreamContent::rays, {camera.region}))
    throw Cancelled();
  keep(gathering.take(execution), camera);
  if (camera.nodes == 0)
    throw mended_by(InputError("no pixel sees the region that the camera is compiled for: give a "
                               "region or a window that it looks at"),
                    {"region", "window"});
  return camera;
}

double CompiledCamera::lit_pixels() const {
  double count = 0;
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    if (tiles[t].groups == 0) continue;
    std::vector<bool> lit(static_cast<std::size_t>(Film::kTile) * Film::kTile);
    for (const CompiledGroup& group : content(t).groups) lit[group.pixel] = true;
    count += static_cast<double>(std::count(lit.begin(), lit.end(), true));
  }
  return count;
}

}  // namespace plenoflame
