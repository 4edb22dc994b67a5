#include "plenoflame/render/ray_stream.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <numeric>
#include <optional>
#include <vector>

#include "optics/kernel_types.h"
#include "plenoflame/base/error.h"
#include "render/run/check_settings.h"
#include "render/run/run_control.h"
#include "render/tracer/path_integrator.h"
#include "render/tracer/pixel_sampler.h"
#include "render/tracer/radiance_integrator.h"
#include "render/transport/channel_sum.h"
#include "render/transport/scene_medium.h"
#include "render/transport/surface_light.h"
#include "render/visibility/camera_front.h"

namespace plenoflame {
namespace {

TraceStatus status_of(int code) {
  if (code == 0) return {};
  const int cause = code % 4;
  return {cause == kCauseVignetted         ? RayStatus::vignetted
          : cause == kCauseTotalReflection ? RayStatus::total_internal_reflection
                                           : RayStatus::missed,
          code / 4};
}

/// A spectral path, with all data for its rays.
template <class Real>
struct StreamPath {
  StreamPath(const CompiledScene& path_scene, const RenderSettings& settings,
             const Execution& execution, RayStreamContent content, const std::vector<Box>& region,
             std::shared_ptr<const SobolPools> pools)
      : scene(path_scene), medium(scene), front(scene.camera) {
    // To find how far windows displace rays takes as long as the rays of some tiles.
    const PixelWindow window = window_of(settings, scene.scene.camera.sensor);
    const bool is_small = window.width <= 2 * Film::kTile && window.height <= 2 * Film::kTile;
    if (settings.skip && !region.empty() && !(scene.windows && is_small))
      beams = SceneBeams::make(scene, region);
    else if (settings.skip && region.empty() && has_content(scene))
      beams = SceneBeams::make(scene);
    if (content == RayStreamContent::radiance) light = PathLight(scene, settings, execution);
    plan = make_pass_plan<Real>(scene, medium.get(), settings, {0, samples_per_replicate(settings)},
                                light, std::move(pools));
    plan.beams = beams.get();
  }
  StreamPath(const StreamPath&) = delete;
  StreamPath& operator=(const StreamPath&) = delete;

  const CompiledScene& scene;
  SceneMedium medium;
  CameraFront front;
  std::unique_ptr<const SceneBeams> beams;
  PathLight light;
  BackwardPlan<Real> plan;
};

/// Arrays of a block, except for the rays' lines and light.
template <class Real>
struct RayFacts {
  std::vector<int> columns = std::vector<int>(kBlockRays), rows = columns, replicates = columns,
                   types = columns, pupil_parts = columns;
  std::vector<LensIndex> lenses = std::vector<LensIndex>(kBlockRays);
  std::vector<TraceStatus> status = std::vector<TraceStatus>(kBlockRays);
  std::vector<Real> etendue = std::vector<Real>(kBlockRays), sampled = etendue;

  void copy(const RayFacts& other, std::size_t from, std::size_t to) {
    columns[to] = other.columns[from];
    rows[to] = other.rows[from];
    replicates[to] = other.replicates[from];
    types[to] = other.types[from];
    pupil_parts[to] = other.pupil_parts[from];
    lenses[to] = other.lenses[from];
    status[to] = other.status[from];
    etendue[to] = other.etendue[from];
    sampled[to] = other.sampled[from];
  }
  void show(std::size_t size, bool has_parts, RayBlock<Real>& block) const {
    block.size = static_cast<int>(size);
    block.columns = {columns.data(), size};
    block.rows = {rows.data(), size};
    block.replicates = {replicates.data(), size};
    block.lenses = {lenses.data(), size};
    block.types = {types.data(), size};
    block.pupil_parts = {pupil_parts.data(), has_parts ? size : 0};
    block.status = {status.data(), size};
    block.etendue = {etendue.data(), size};
    block.sampled_etendue = {sampled.data(), size};
  }
};

/// Writes the rays of one path to public blocks. One object for each worker.
template <class Real>
class BlockWriter : public RayConsumer<Real> {
 public:
  /// @param samples per pixel and microlens, all replicates together
  BlockWriter(const StreamPath<Real>& path, int number, double samples, RayStreamContent content,
              int worker, const RayBlockConsumer<Real>& consumer)
      : path_(path),
        samples_(samples),
        worker_(worker),
        consumer_(consumer),
        sampler_(path.plan, *this),
        has_parts_(!path.scene.camera.pupil_filters().empty()),
        paths_(path.scene) {
    if (content == RayStreamContent::radiance) integrator_.emplace(path.plan);
    block_.path = number;
    block_.scene = &path.scene;
  }
  BlockWriter(const BlockWriter&) = delete;
  BlockWriter& operator=(const BlockWriter&) = delete;

  /// @param sequence number of the next block of the tile; is increased
  /// @param reached is called with the completed share of the tile's rows
  void trace(int index, const PixelWindow& tile, int& sequence,
             const std::function<void(double)>& reached) {
    sequence_ = &sequence;
    tile_ = tile;
    row_ = tile.y;
    reached_ = &reached;
    sampler_.trace(index, tile);
  }

  void begin_tile(int index, const PixelWindow&) override { block_.tile = index; }
  bool wants_drawn() const override { return true; }
  void drawn(const DrawnRays<Real>& rays) override {
    std::copy_n(rays.block.weight + rays.first, rays.count, facts_.sampled.begin() + rays.first);
    std::fill_n(facts_.lenses.begin() + rays.first, rays.count, rays.lens);
    std::fill_n(facts_.types.begin() + rays.first, rays.count, rays.type);
  }
  void traced(const TracedRays<Real>& rays) override {
    write(rays);
    if (rays.pixels.empty() || rays.pixels.back().row <= row_) return;
    row_ = rays.pixels.back().row;
    (*reached_)(static_cast<double>(row_ - tile_.y) / tile_.height);
  }

 private:
  void write(const TracedRays<Real>& rays) {
    for (const PixelRays& pixel : rays.pixels) set_pixel(rays, pixel);
    set_ends(rays);
    if (integrator_) integrator_->integrate(rays);
    const PathIntegrator<Real>* const followed = integrator_ ? integrator_->along_paths() : nullptr;
    if (!followed) trace_paths(rays, path_.plan.anchor, paths_);
    const WorldPaths& paths = followed ? followed->paths() : paths_;
    std::size_t most = 1;
    for (std::size_t i = 0; i < paths.size(); ++i) most = std::max(most, paths[i].count);
    // First the lines of the rays themselves, up to the end of their first stretch.
    facts_.show(static_cast<std::size_t>(rays.count), has_parts_, block_);
    set_lines(rays, paths);
    if (integrator_ && most == 1) set_radiance(rays);
    if (most > 1 && !stretches_) stretches_ = std::make_unique<StretchArrays>();
    for (std::size_t k = 0; k < most; ++k) {
      if (most > 1) choose(rays, paths, k);
      if (k > 0) set_stretches(paths, k);
      if (followed && most > 1) set_shares(*followed, k);
      block_.sequence = (*sequence_)++;
      consumer_(block_, worker_);
    }
  }

  void set_lines(const TracedRays<Real>& rays, const WorldPaths& paths) {
    RayBatch<Real>& lines = block_.rays;
    lines.size = rays.padded;
    lines.anchor = path_.plan.anchor;
    lines.x = rays.block.x;
    lines.y = rays.block.y;
    lines.z = rays.block.z;
    lines.dx = rays.block.dx;
    lines.dy = rays.block.dy;
    lines.dz = rays.block.dz;
    Real* const near = extents_[0];
    Real* const far = extents_[1];
    for (int i = 0; i < rays.count; ++i) {
      const WorldPath& path = paths[static_cast<std::size_t>(i)];
      const double from = path_.front.t_near(line_of(rays.block, i, lines.anchor));
      const double norm =
          length({static_cast<double>(lines.dx[i]), static_cast<double>(lines.dy[i]),
                  static_cast<double>(lines.dz[i])});
      near[i] = static_cast<Real>(from / norm);
      far[i] = std::numeric_limits<Real>::infinity();
      if (path.count > 0)
        far[i] = static_cast<Real>((from + paths.stretches(path).front().far) / norm);
    }
    std::fill(near + rays.count, near + rays.padded, near[0]);
    std::fill(far + rays.count, far + rays.padded, far[0]);
    lines.t_near = near;
    lines.t_far = far;
  }

  /// How the rays ended in the camera, and where they passed the stop.
  void set_ends(const TracedRays<Real>& rays) {
    const PupilFilters& filters = path_.scene.camera.pupil_filters();
    for (int i = 0; i < rays.count; ++i) {
      const auto at = static_cast<std::size_t>(i);
      facts_.status[at] = status_of(rays.block.code[i]);
      if (has_parts_)
        facts_.pupil_parts[at] = filters.part_at(
            {static_cast<double>(rays.block.stop_x[i]), static_cast<double>(rays.block.stop_y[i])});
    }
  }

  void set_pixel(const TracedRays<Real>& rays, const PixelRays& pixel) {
    const double scale = pixel.scale / samples_;
    for (int k = 0; k < pixel.count; ++k) {
      const int i = pixel.first + k;
      const auto at = static_cast<std::size_t>(i);
      facts_.columns[at] = pixel.column;
      facts_.rows[at] = pixel.row;
      facts_.replicates[at] = (pixel.offset + k) / pixel.points;
      facts_.etendue[at] = static_cast<Real>(scale * static_cast<double>(rays.block.weight[i]));
      facts_.sampled[at] = static_cast<Real>(scale * static_cast<double>(facts_.sampled[at]));
    }
  }

  void set_radiance(const TracedRays<Real>& rays) {
    const std::size_t channels = path_.scene.scene.channels.size();
    const auto stride = static_cast<std::size_t>(rays.padded);
    radiance_.resize(channels * stride);
    for (std::size_t c = 0; c < channels; ++c)
      std::copy_n(integrator_->radiance() + c * kPaddedBlock, stride,
                  radiance_.begin() + static_cast<std::ptrdiff_t>(c * stride));
    block_.radiance = radiance_;
    block_.transmittance = {integrator_->transmittance(), static_cast<std::size_t>(rays.count)};
  }

  /// Chooses the rays of a block of stretches; the first one's has all rays.
  void choose(const TracedRays<Real>& rays, const WorldPaths& paths, std::size_t k) {
    stretches_->rays.clear();
    for (int i = 0; i < rays.count; ++i)
      if (k == 0 || paths[static_cast<std::size_t>(i)].count > k) stretches_->rays.push_back(i);
  }

  /// Fills in stretch k of the chosen rays.
  void set_stretches(const WorldPaths& paths, std::size_t k) {
    StretchArrays& to = *stretches_;
    const std::size_t size = to.rays.size();
    const std::size_t padded = (size + kRayPadding - 1) / kRayPadding * kRayPadding;
    const Vec3 anchor = path_.plan.anchor;
    for (std::size_t j = 0; j < size; ++j) {
      const auto from = static_cast<std::size_t>(to.rays[j]);
      const AirSegment& stretch = paths.stretches(paths[from])[k];
      const Vec3 o = stretch.ray.origin - anchor, d = stretch.ray.direction;
      const double values[] = {o.x, o.y, o.z, d.x, d.y, d.z, 0, stretch.far};
      for (std::size_t c = 0; c < std::size(values); ++c)
        to.columns[c][j] = static_cast<Real>(values[c]);
      to.facts.copy(facts_, from, j);
      to.facts.etendue[j] *= static_cast<Real>(stretch.throughput);
    }
    for (std::size_t c = 0; c < 8; ++c)
      std::fill(to.columns[c] + size, to.columns[c] + padded, to.columns[c][0]);
    RayBatch<Real>& lines = block_.rays;
    lines.size = static_cast<int>(padded);
    lines.x = to.columns[0], lines.y = to.columns[1], lines.z = to.columns[2];
    lines.dx = to.columns[3], lines.dy = to.columns[4], lines.dz = to.columns[5];
    lines.t_near = to.columns[6], lines.t_far = to.columns[7];
    to.facts.show(size, has_parts_, block_);
  }

  /// The light of stretch k of the chosen rays.
  void set_shares(const PathIntegrator<Real>& followed, std::size_t k) {
    StretchArrays& to = *stretches_;
    const WorldPaths& paths = followed.paths();
    const auto padded = static_cast<std::size_t>(block_.rays.size);
    to.shares.assign(static_cast<std::size_t>(path_.scene.node_count()) * padded, Real(0));
    to.transmittance.assign(to.rays.size(), Real(1));
    for (std::size_t j = 0; j < to.rays.size(); ++j) {
      const WorldPath& path = paths[static_cast<std::size_t>(to.rays[j])];
      if (path.count <= k) continue;
      const std::size_t s = path.first + k;
      to.transmittance[j] = static_cast<Real>(followed.transmittance(s));
      // The etendue contains the losses in the glass.
      const auto through = static_cast<Real>(paths.stretches()[s].throughput);
      for (std::size_t n = 0; through > 0 && n * padded < to.shares.size(); ++n)
        to.shares[n * padded + j] = followed.shares()[n * paths.stretches().size() + s] / through;
    }
    const int stride = block_.rays.size;
    if (path_.scene.part_mixes.empty())
      sum_channels(path_.scene.mix, to.shares.data(), stride, stride);
    else
      sum_channels_by_mix(path_.scene.part_mixes, (k > 0 ? to.facts : facts_).pupil_parts.data(),
                          to.shares.data(), stride, stride);
    block_.radiance = std::span(to.shares).first(path_.scene.scene.channels.size() * padded);
    block_.transmittance = to.transmittance;
  }

  /// The arrays of a block of stretches.
  struct StretchArrays {
    AlignedColumns<Real> columns{8};
    std::vector<int> rays;  ///< the ray of each stretch
    RayFacts<Real> facts;
    std::vector<Real> shares, transmittance;
  };

  const StreamPath<Real>& path_;
  double samples_;
  int worker_;
  const RayBlockConsumer<Real>& consumer_;
  PixelSampler<Real> sampler_;
  std::optional<RadianceIntegrator<Real>> integrator_;
  int* sequence_ = nullptr;
  PixelWindow tile_;
  int row_ = 0;  ///< row of tile_ that the rays have reached
  const std::function<void(double)>* reached_ = nullptr;
  RayBlock<Real> block_;
  AlignedColumns<Real> extents_{2};  ///< t_near, t_far
  RayFacts<Real> facts_;
  bool has_parts_;  ///< filters cover parts of the stop
  std::vector<Real> radiance_;
  WorldPaths paths_;                          ///< used if no integrator follows them
  std::unique_ptr<StretchArrays> stretches_;  ///< nullptr: there was one for each ray so far
};

void check_stream(const RenderSettings& settings, const SensorSpec& sensor) {
  check_settings(settings, sensor);
  if (settings.estimator != Estimator::backward)
    throw UsageError(
        "a ray stream takes the backward estimator: bundles of light run the other way");
  if (!has_fixed_samples(settings))
    throw UsageError(
        "a ray stream takes a fixed number of samples: no target error, no time limit");
}

}  // namespace

template <class Real>
bool stream_rays(const CompiledScene& scene, const RenderSettings& settings,
                 const Execution& execution, const RayBlockConsumer<Real>& consumer,
                 RayStreamContent content, const std::vector<Box>& region) {
  const SensorSpec& sensor = scene.scene.camera.sensor;
  check_stream(settings, sensor);
  const double samples = static_cast<double>(samples_per_replicate(settings)) * settings.replicates;
  std::vector<std::unique_ptr<StreamPath<Real>>> paths;
  for (const CompiledScene& path : scene.paths())
    paths.push_back(std::make_unique<StreamPath<Real>>(
        path, settings, execution, content, region,
        paths.empty() ? nullptr : paths.front()->plan.pools_of_range));

  const Film tiles(window_of(settings, sensor), 1, 1);
  using Writers = std::vector<std::unique_ptr<BlockWriter<Real>>>;
  std::vector<Writers> writers(static_cast<std::size_t>(execution.thread_count()));
  std::mutex mutex;
  std::size_t done = 0;
  std::vector<double> under_way(writers.size());  ///< completed share of each worker's tile
  const auto count = static_cast<std::size_t>(tiles.tile_count());
  // Tiles may be few and slow, so their shares are reported, too.
  const auto report = [&](int worker, double share) {
    if (!execution.progress) return;
    const std::lock_guard lock(mutex);
    done += share < 1 ? 0 : 1;
    under_way[static_cast<std::size_t>(worker)] = share < 1 ? share : 0;
    const double parts = std::accumulate(under_way.begin(), under_way.end(), 0.0);
    Progress progress;
    progress.fraction = (static_cast<double>(done) + parts) / static_cast<double>(count);
    execution.progress(progress);
  };
  return parallel_for(execution, count, [&](std::size_t tile, int worker) {
    Writers& own = writers[static_cast<std::size_t>(worker)];
    if (own.empty())
      for (std::size_t p = 0; p < paths.size(); ++p)
        own.push_back(std::make_unique<BlockWriter<Real>>(*paths[p], static_cast<int>(p), samples,
                                                          content, worker, consumer));
    int sequence = 0;
    const int index = static_cast<int>(tile);
    const auto paths_in_all = static_cast<double>(own.size());
    for (std::size_t p = 0; p < own.size(); ++p)
      own[p]->trace(index, tiles.tile(index), sequence, [&](double share) {
        report(worker, (static_cast<double>(p) + share) / paths_in_all);
      });
    report(worker, 1);
  });
}

template bool stream_rays<float>(const CompiledScene&, const RenderSettings&, const Execution&,
                                 const RayBlockConsumer<float>&, RayStreamContent,
                                 const std::vector<Box>&);
template bool stream_rays<double>(const CompiledScene&, const RenderSettings&, const Execution&,
                                  const RayBlockConsumer<double>&, RayStreamContent,
                                  const std::vector<Box>&);

}  // namespace plenoflame
