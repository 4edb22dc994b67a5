#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "plenoflame/base/error.h"
#include "plenoflame/render/compiled_camera.h"
#include "render/compiled/bundle_file.h"
#include "render/compiled/compiled_work.h"
#include "render/estimators/backward.h"
#include "render/estimators/rank_tiles.h"
#include "render/run/check_settings.h"
#include "render/run/finish_picture.h"
#include "render/run/run_control.h"
#include "render/sampling/aligned_columns.h"
#include "render/transport/channel_sum.h"
#include "render/transport/scene_medium.h"

namespace plenoflame {
namespace {

constexpr int kNodesOfBatch = kMaxBatch;

bool meet(const PixelWindow& a, const PixelWindow& b) {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

/// A spectral path, and the medium that its rays see.
struct NodePath {
  explicit NodePath(const CompiledScene& path) : scene(path), medium(path) {}
  const CompiledScene& scene;
  SceneMedium medium;
};

/// Integrates the nodes of tiles. One for each worker.
template <class Real>
class NodeIntegrator {
 public:
  NodeIntegrator(const CompiledCamera& camera, const std::vector<std::unique_ptr<NodePath>>& paths,
                 const MediumOptions& options, std::size_t nodes)
      : camera_(camera), paths_(paths), options_(options), columns_(kRadiance + nodes) {}

  /// Adds the pixels of a tile of the film.
  /// @param content returns the content of a tile of the camera
  template <class Content>
  void add_to(int film_tile, const Film& tiles, Film& film, const Content& content) {
    const PixelWindow place = film.tile(film_tile);
    sums_ = nullptr;
    place_ = place;
    for (int t = 0; t < tiles.tile_count(); ++t) {
      const auto number = static_cast<std::size_t>(t);
      if (camera_.tiles[number].groups == 0 || !meet(tiles.tile(t), place)) continue;
      const CompiledContent kept = content(number);
      if (!sums_) sums_ = film.tile_sums(film_tile).data();
      add(kept, tiles.tile(t));
    }
    flush();
  }
  const WorkCounters& counters() const { return counters_; }

 private:
  enum Column : std::size_t { kX, kY, kZ, kDx, kDy, kDz, kTransmittance, kRadiance };

  void add(const CompiledContent& content, const PixelWindow& from) {
    std::size_t node = 0;
    for (const CompiledGroup& group : content.groups) {
      const int column = from.x + group.pixel % Film::kTile - place_.x;
      const int row = from.y + group.pixel / Film::kTile - place_.y;
      const std::size_t end = node + group.count[0] + group.count[1];
      if (column < 0 || row < 0 || column >= place_.width || row >= place_.height) {
        node = end;
        continue;
      }
      if (group.path != path_) flush();
      path_ = group.path;
      const std::size_t second = node + group.count[0];
      const std::size_t pixel = static_cast<std::size_t>(row * place_.width + column);
      for (; node < end; ++node) {
        if (count_ == kNodesOfBatch) flush();
        put(group, content.nodes[node], pixel + (node < second ? 0 : pixels()));
      }
    }
  }

  std::size_t pixels() const {
    return static_cast<std::size_t>(place_.width) * static_cast<std::size_t>(place_.height);
  }

  void put(const CompiledGroup& group, const CompiledNode& node, std::size_t target) {
    const auto i = static_cast<std::size_t>(count_++);
    Real place[4];
    for (std::size_t k = 0; k < 4; ++k)
      place[k] = static_cast<Real>(group.lower[k]) +
                 static_cast<Real>(group.step[k]) * static_cast<Real>(node.place[k]);
    const Vec3 &u = camera_.across, &v = camera_.down, &w = camera_.along;
    const Real norm = 1 / std::sqrt(1 + place[2] * place[2] + place[3] * place[3]);
    columns_[kX][i] = place[0] * static_cast<Real>(u.x) + place[1] * static_cast<Real>(v.x);
    columns_[kY][i] = place[0] * static_cast<Real>(u.y) + place[1] * static_cast<Real>(v.y);
    columns_[kZ][i] = place[0] * static_cast<Real>(u.z) + place[1] * static_cast<Real>(v.z);
    const auto along = [&](double a, double b, double c) {
      return norm * (static_cast<Real>(c) + place[2] * static_cast<Real>(a) +
                     place[3] * static_cast<Real>(b));
    };
    columns_[kDx][i] = along(u.x, v.x, w.x);
    columns_[kDy][i] = along(u.y, v.y, w.y);
    columns_[kDz][i] = along(u.z, v.z, w.z);
    targets_[i] = target;
    weights_[i] = static_cast<double>(node.weight);
    parts_[i] = group.part;
  }

  void flush() {
    if (count_ == 0) return;
    const int padded = (count_ + kRayPadding - 1) / kRayPadding * kRayPadding;
    for (std::size_t c = 0; c < kTransmittance; ++c)
      std::fill(columns_[c] + count_, columns_[c] + padded, columns_[c][0]);
    std::fill(parts_.begin() + count_, parts_.begin() + padded, parts_[0]);
    const NodePath& path = *paths_[path_];
    RayBatch<Real> batch;
    batch.size = padded;
    batch.anchor = camera_.anchor;
    batch.x = columns_[kX], batch.y = columns_[kY], batch.z = columns_[kZ];
    batch.dx = columns_[kDx], batch.dy = columns_[kDy], batch.dz = columns_[kDz];
    Real* const radiance = columns_[kRadiance];
    path.medium.get().integrate(
        batch, options_, {radiance, kPaddedBlock, columns_[kTransmittance], 0}, counters_.medium);
    if (path.scene.part_mixes.empty())
      sum_channels(path.scene.mix, radiance, kPaddedBlock, padded);
    else
      sum_channels_by_mix(path.scene.part_mixes, parts_.data(), radiance, kPaddedBlock, padded);
    const std::size_t channels = path.scene.scene.channels.size();
    for (std::size_t c = 0; c < channels; ++c) {
      const std::size_t to = path.scene.film_channel.empty()
                                 ? c
                                 : static_cast<std::size_t>(path.scene.film_channel[c]);
      double* const sums = sums_ + 2 * to * pixels();
      const Real* const values = radiance + c * static_cast<std::size_t>(kPaddedBlock);
      for (std::size_t i = 0; i < static_cast<std::size_t>(count_); ++i)
        sums[targets_[i]] += weights_[i] * static_cast<double>(values[i]);
    }
    counters_.rays += count_;
    counters_.rays_reached += count_;
    count_ = 0;
  }

  const CompiledCamera& camera_;
  const std::vector<std::unique_ptr<NodePath>>& paths_;
  MediumOptions options_;
  AlignedColumns<Real> columns_;
  PixelWindow place_;       ///< window of the film's tile
  double* sums_ = nullptr;  ///< sums of that tile
  std::vector<std::size_t> targets_ = std::vector<std::size_t>(kNodesOfBatch);  ///< of the nodes
  std::vector<double> weights_ = std::vector<double>(kNodesOfBatch);
  std::vector<int> parts_ = std::vector<int>(kNodesOfBatch + kRayPadding);
  int count_ = 0;
  std::size_t path_ = 0;
  WorkCounters counters_;
};

/// TileWork with the nodes of a compiled camera, in one precision.
template <class Real>
struct CompiledTiles {
  const CompiledScene& scene;
  const CompiledCamera& camera;
  const RenderSettings& settings;
  std::string name;  ///< of the camera's file

  void operator()(const NextTile& next, const Execution& execution, Film& film,
                  RenderStatistics& statistics, const TileDone& tile_done) const;
};

template <class Real>
void CompiledTiles<Real>::operator()(const NextTile& next, const Execution& execution, Film& film,
                                     RenderStatistics& statistics,
                                     const TileDone& tile_done) const {
  std::vector<std::unique_ptr<NodePath>> paths;
  std::size_t nodes = 1, parts = 1;
  for (const CompiledScene& path : scene.paths()) {
    paths.push_back(std::make_unique<NodePath>(path));
    nodes = std::max(nodes, static_cast<std::size_t>(path.node_count()));
    parts = std::max(parts, path.part_mixes.size());
  }
  MediumOptions options;
  options.isa = settings.isa;
  options.skip = settings.skip;
  // A tile of the camera may overlap four tiles of the film. Only one worker adds to each of these.
  const Film tiles(camera.window, 1, 1);
  const auto threads = static_cast<std::size_t>(execution.thread_count());
  std::mutex mutex;
  std::atomic<bool> failed = false;
  parallel_for(execution, threads, [&](std::size_t, int) {
    NodeIntegrator<Real> own(camera, paths, options, nodes);
    try {
      while (!failed && !execution.stop.stop_requested()) {
        const std::optional<TileJob> job = next();
        if (!job) break;
        const double before = own.counters().rays;
        own.add_to(job->tile, tiles, film, [&](std::size_t tile) {
          return content_for(camera, tile, paths.size(), parts, name);
        });
        film.add_samples(job->tile, 1);
        const std::lock_guard lock(mutex);
        if (tile_done) tile_done(*job, own.counters().rays - before);
      }
    } catch (...) {
      failed = true;
      throw;
    }
    const std::lock_guard lock(mutex);
    static_cast<WorkCounters&>(statistics) += own.counters();
  });
}

bool is_single(const CompiledScene& scene, const RenderSettings& settings) {
  return settings.precision == Precision::single_precision ||
         (settings.precision == Precision::automatic && single_precision_suffices(scene));
}

/// Adds all tiles of the part. @return false when it was stopped
bool add_all_tiles(const TileWork& work, const RenderSettings& settings, const Execution& execution,
                   RenderResult& result) {
  Film& film = result.film;
  std::vector<TileJob> jobs;
  const Part& part = settings.part;
  for (int tile = 0; tile < film.tile_count(); ++tile)
    if (part_of_tile(tile, film.tiles_across(), part.count) == part.number - 1)
      jobs.push_back({tile, 0});
  std::size_t done = 0;
  const TileDone tell = [&](const TileJob&, double) {
    Progress progress;
    progress.fraction = static_cast<double>(++done) / static_cast<double>(jobs.size());
    if (execution.progress) execution.progress(progress);
  };
  if (settings.ranks && settings.ranks->size() > 1) {
    const std::vector<PointRange> ranges{{0, 1, false}};
    RankTiles ranks(*settings.ranks, settings, execution.stop);
    ranks.begin_pass(ranges);
    if (!ranks.run(work, ranges, jobs, execution, film, result.statistics, tell)) return false;
    ranks.end_pass(result.statistics);
    return true;
  }
  std::atomic<std::size_t> given = 0;
  work(
      [&]() -> std::optional<TileJob> {
        const std::size_t i = given++;
        return i < jobs.size() ? std::optional(jobs[i]) : std::nullopt;
      },
      execution, film, result.statistics, tell);
  return done == jobs.size();
}

}  // namespace

TileWork compiled_work(const CompiledScene& scene, const CompiledCamera& camera,
                       const RenderSettings& settings, const std::string& name) {
  if (is_single(scene, settings)) return CompiledTiles<float>{scene, camera, settings, name};
  return CompiledTiles<double>{scene, camera, settings, name};
}

RenderResult render_compiled(const CompiledScene& scene, const CompiledCamera& camera,
                             const RenderSettings& given, const Execution& execution,
                             const std::string& name) {
  const auto start = std::chrono::steady_clock::now();
  check_compiled(scene, camera, name);
  RenderSettings settings = given;
  settings.estimator = Estimator::backward;
  settings.replicates = 2;
  settings.samples = std::max(2, camera.samples);
  settings.seed = camera.seed;
  settings.target_error = settings.time_limit = 0;
  check_settings(settings, scene.scene.camera.sensor);
  if (settings.window.width == 0) settings.window = camera.window;
  check_compiled_window(camera, settings.window, name);
  check_part(settings.part, settings.window);
  RenderResult result;
  result.film = Film(settings.window, static_cast<int>(scene.scene.channels.size()), 2);
  begin_statistics(scene, settings, execution, result.statistics);
  result.statistics.precision = is_single(scene, settings) ? "single" : "double";
  result.statistics.complete =
      add_all_tiles(compiled_work(scene, camera, settings, name), settings, execution, result);
  finish_picture(scene, settings, execution, result);
  result.light_field.estimator = "compiled";
  result.statistics.seconds = seconds_since(start);
  return result;
}

}  // namespace plenoflame
