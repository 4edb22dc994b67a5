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
#include "render/tracer/pixel_sampler.h"
#include "render/tracer/radiance_integrator.h"
#include "render/tracer/window_integrator.h"
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
    if (settings.skip && !region.empty()) {
      if (!scene.windows) beams = std::make_unique<const SceneBeams>(scene, region);
    } else if (settings.skip && has_content(scene)) {
      beams = SceneBeams::make(scene);
    }
    if (content == RayStreamContent::radiance) {
      light = PathLight(scene, settings, execution);
    }
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
        columns_(4) {
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
    std::copy_n(rays.block.weight + rays.first, rays.count, columns_[kSampled] + rays.first);
    std::fill_n(lenses_.begin() + rays.first, rays.count, rays.lens);
    std::fill_n(types_.begin() + rays.first, rays.count, rays.type);
  }
  void traced(const TracedRays<Real>& rays) override {
    write(rays);
    if (rays.pixels.empty() || rays.pixels.back().row <= row_) return;
    row_ = rays.pixels.back().row;
    (*reached_)(static_cast<double>(row_ - tile_.y) / tile_.height);
  }

 private:
  enum Column : std::size_t { kEtendue, kSampled, kNear, kFar };

  void write(const TracedRays<Real>& rays) {
    block_.sequence = (*sequence_)++;
    block_.size = rays.count;
    set_lines(rays);
    for (const PixelRays& pixel : rays.pixels) set_pixel(rays, pixel);
    for (int i = 0; i < rays.count; ++i)
      status_[static_cast<std::size_t>(i)] = status_of(rays.block.code[i]);
    set_pupil_parts(rays);
    if (path_.scene.windows) {
      write_stretches(rays);
      return;
    }
    if (integrator_) set_radiance(rays);
    set_extents(rays);
    const auto size = static_cast<std::size_t>(rays.count);
    block_.columns = {pixel_columns_.data(), size};
    block_.rows = {pixel_rows_.data(), size};
    block_.replicates = {replicates_.data(), size};
    block_.lenses = {lenses_.data(), size};
    block_.types = {types_.data(), size};
    block_.pupil_parts = {pupil_parts_.data(), pupil_parts_.empty() ? 0 : size};
    block_.status = {status_.data(), size};
    block_.etendue = {columns_[kEtendue], size};
    block_.sampled_etendue = {columns_[kSampled], size};
    consumer_(block_, worker_);
  }

  void set_lines(const TracedRays<Real>& rays) {
    RayBatch<Real>& lines = block_.rays;
    lines.size = rays.padded;
    lines.anchor = path_.plan.anchor;
    lines.x = rays.block.x;
    lines.y = rays.block.y;
    lines.z = rays.block.z;
    lines.dx = rays.block.dx;
    lines.dy = rays.block.dy;
    lines.dz = rays.block.dz;
    lines.t_near = columns_[kNear];
    lines.t_far = columns_[kFar];
  }

  void set_pupil_parts(const TracedRays<Real>& rays) {
    const PupilFilters& filters = path_.scene.camera.pupil_filters();
    if (filters.empty()) return;
    pupil_parts_.resize(kBlockRays);
    for (int i = 0; i < rays.count; ++i)
      pupil_parts_[static_cast<std::size_t>(i)] = filters.part_at(
          {static_cast<double>(rays.block.stop_x[i]), static_cast<double>(rays.block.stop_y[i])});
  }

  void set_pixel(const TracedRays<Real>& rays, const PixelRays& pixel) {
    const double scale = pixel.scale / samples_;
    for (int k = 0; k < pixel.count; ++k) {
      const int i = pixel.first + k;
      const auto at = static_cast<std::size_t>(i);
      pixel_columns_[at] = pixel.column;
      pixel_rows_[at] = pixel.row;
      replicates_[at] = (pixel.offset + k) / pixel.points;
      columns_[kEtendue][i] = static_cast<Real>(scale * static_cast<double>(rays.block.weight[i]));
      columns_[kSampled][i] = static_cast<Real>(scale * static_cast<double>(columns_[kSampled][i]));
    }
  }

  void set_extents(const TracedRays<Real>& rays) {
    Real* const near = columns_[kNear];
    Real* const far = columns_[kFar];
    const Real* const known = integrator_ ? integrator_->ends() : nullptr;
    const SurfaceScene* const surfaces = path_.scene.surfaces.get();
    for (int i = 0; i < rays.count; ++i) {
      const KernelBlock<Real>& block = rays.block;
      const Vec3 along{static_cast<double>(block.dx[i]), static_cast<double>(block.dy[i]),
                       static_cast<double>(block.dz[i])};
      const double norm = length(along);
      const Ray ray{
          path_.plan.anchor + Vec3{static_cast<double>(block.x[i]), static_cast<double>(block.y[i]),
                                   static_cast<double>(block.z[i])},
          (1 / norm) * along};
      const double from = path_.front.t_near(ray);
      near[i] = static_cast<Real>(from / norm);
      far[i] = known ? known[i] : std::numeric_limits<Real>::infinity();
      SurfaceHit hit;
      if (!known && surfaces && block.weight[i] > 0 &&
          surfaces->intersect(ray, from, std::numeric_limits<double>::infinity(), {}, hit))
        far[i] = static_cast<Real>(hit.t / norm);
    }
    std::fill(near + rays.count, near + rays.padded, near[0]);
    std::fill(far + rays.count, far + rays.padded, far[0]);
  }

  void set_radiance(const TracedRays<Real>& rays) {
    integrator_->integrate(rays);
    const std::size_t channels = path_.scene.scene.channels.size();
    const auto stride = static_cast<std::size_t>(rays.padded);
    radiance_.resize(channels * stride);
    for (std::size_t c = 0; c < channels; ++c)
      std::copy_n(integrator_->radiance() + c * kPaddedBlock, stride,
                  radiance_.begin() + static_cast<std::ptrdiff_t>(c * stride));
    block_.radiance = radiance_;
    block_.transmittance = {integrator_->transmittance(), static_cast<std::size_t>(rays.count)};
  }

  /// Writes the lines of rays through windows: blocks of all first stretches, then of all second
  /// ones, and so on.
  void write_stretches(const TracedRays<Real>& rays) {
    const WindowWays* ways = &ways_;
    if (integrator_) {
      integrator_->integrate(rays);
      ways = &integrator_->windows()->ways();
    } else {
      trace_ways(rays, *path_.scene.windows, path_.plan.anchor, path_.front, window_path_, ways_);
      SurfaceHit hit;
      for (WindowWays::Way& way : ways_.ways)
        if (path_.scene.surfaces) cut_at_surface(*path_.scene.surfaces, ways_, way, hit);
    }
    std::size_t most = 1;
    for (const WindowWays::Way& way : ways->ways) most = std::max(most, way.count);
    if (!stretches_) stretches_ = std::make_unique<StretchArrays>();
    --*sequence_;  // it was increased for the whole block
    for (std::size_t k = 0; k < most; ++k) {
      std::vector<int>& chosen = stretches_->rays;
      chosen.clear();
      for (int i = 0; i < rays.count; ++i)
        if (k == 0 || ways->ways[static_cast<std::size_t>(i)].count > k) chosen.push_back(i);
      block_.sequence = (*sequence_)++;
      set_stretches(rays, *ways, k);
      consumer_(block_, worker_);
    }
  }

  /// Fills stretch k of the chosen rays; a ray that ended in the camera is a line in front of it.
  void set_stretches(const TracedRays<Real>& rays, const WindowWays& ways, std::size_t k) {
    StretchArrays& to = *stretches_;
    const std::size_t size = to.rays.size();
    const std::size_t padded = (size + kRayPadding - 1) / kRayPadding * kRayPadding;
    to.shares.assign(static_cast<std::size_t>(path_.scene.node_count()) * padded, Real(0));
    to.transmittance.assign(size, Real(1));
    const Vec3 anchor = path_.plan.anchor;
    for (std::size_t j = 0; j < size; ++j) {
      const int i = to.rays[j];
      const auto from = static_cast<std::size_t>(i);
      const WindowWays::Way& way = ways.ways[from];
      AirSegment stretch;
      stretch.far = kInfinity;
      if (way.count > k)
        stretch = ways.segments[way.first + k];
      else
        stretch.ray = ray_from_front(rays.block, i, anchor, path_.front);
      const Vec3 o = stretch.ray.origin - anchor, d = stretch.ray.direction;
      const double values[] = {o.x, o.y, o.z, d.x, d.y, d.z, 0, stretch.far};
      for (std::size_t c = 0; c < std::size(values); ++c)
        to.columns[c][j] = static_cast<Real>(values[c]);
      to.columns[8][j] =
          columns_[kEtendue][i] * static_cast<Real>(way.count > k ? stretch.throughput : 1);
      to.columns[9][j] = columns_[kSampled][i];
      to.pixel_columns[j] = pixel_columns_[from];
      to.pixel_rows[j] = pixel_rows_[from];
      to.replicates[j] = replicates_[from];
      to.types[j] = types_[from];
      to.lenses[j] = lenses_[from];
      to.status[j] = status_[from];
      if (!integrator_ || way.count <= k) continue;
      const WindowIntegrator<Real>& windows = *integrator_->windows();
      to.transmittance[j] = static_cast<Real>(windows.transmittance(way.first + k));
      // The etendue contains the losses in the glass.
      for (std::size_t n = 0; stretch.throughput > 0 && n * padded < to.shares.size(); ++n)
        to.shares[n * padded + j] = windows.shares()[n * ways.segments.size() + way.first + k] /
                                    static_cast<Real>(stretch.throughput);
    }
    for (std::size_t c = 0; c < 8; ++c)
      std::fill(to.columns[c] + size, to.columns[c] + padded, to.columns[c][0]);
    RayBatch<Real>& lines = block_.rays;
    lines.size = static_cast<int>(padded);
    lines.anchor = anchor;
    lines.x = to.columns[0], lines.y = to.columns[1], lines.z = to.columns[2];
    lines.dx = to.columns[3], lines.dy = to.columns[4], lines.dz = to.columns[5];
    lines.t_near = to.columns[6], lines.t_far = to.columns[7];
    block_.size = static_cast<int>(size);
    block_.columns = {to.pixel_columns.data(), size};
    block_.rows = {to.pixel_rows.data(), size};
    block_.replicates = {to.replicates.data(), size};
    block_.lenses = {to.lenses.data(), size};
    block_.types = {to.types.data(), size};
    to.pupil_parts.assign(pupil_parts_.empty() ? 0 : padded, 0);
    if (!pupil_parts_.empty())
      for (std::size_t j = 0; j < size; ++j)
        to.pupil_parts[j] = pupil_parts_[static_cast<std::size_t>(to.rays[j])];
    block_.pupil_parts = {to.pupil_parts.data(), pupil_parts_.empty() ? 0 : size};
    block_.status = {to.status.data(), size};
    block_.etendue = {to.columns[8], size};
    block_.sampled_etendue = {to.columns[9], size};
    if (!integrator_) return;
    const auto stride = static_cast<int>(padded);
    if (path_.scene.part_mixes.empty()) {
      sum_channels(path_.scene.mix, to.shares.data(), stride, stride);
    } else {
      sum_channels_by_mix(path_.scene.part_mixes, to.pupil_parts.data(), to.shares.data(), stride,
                          stride);
    }
    to.shares.resize(path_.scene.scene.channels.size() * padded);
    block_.radiance = to.shares;
    block_.transmittance = to.transmittance;
  }

  /// The arrays of a block of stretches.
  struct StretchArrays {
    AlignedColumns<Real> columns{10};
    std::vector<int> rays;  ///< the ray of each stretch
    std::vector<int> pixel_columns = std::vector<int>(kBlockRays),
                     pixel_rows = std::vector<int>(kBlockRays),
                     replicates = std::vector<int>(kBlockRays),
                     types = std::vector<int>(kBlockRays);
    std::vector<LensIndex> lenses = std::vector<LensIndex>(kBlockRays);
    std::vector<TraceStatus> status = std::vector<TraceStatus>(kBlockRays);
    std::vector<int> pupil_parts;  ///< parts of the stop that they pass
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
  AlignedColumns<Real> columns_;
  std::vector<int> pixel_columns_ = std::vector<int>(kBlockRays),
                   pixel_rows_ = std::vector<int>(kBlockRays),
                   replicates_ = std::vector<int>(kBlockRays),
                   types_ = std::vector<int>(kBlockRays);
  std::vector<LensIndex> lenses_ = std::vector<LensIndex>(kBlockRays);
  std::vector<int> pupil_parts_;  ///< empty without filters
  std::vector<TraceStatus> status_ = std::vector<TraceStatus>(kBlockRays);
  std::vector<Real> radiance_;
  WindowPath window_path_;
  WindowWays ways_;                           ///< used if no integrator follows them
  std::unique_ptr<StretchArrays> stretches_;  ///< in scenes with windows
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
