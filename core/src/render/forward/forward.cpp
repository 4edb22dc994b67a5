#include "render/forward/forward.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "film/image_sums.h"
#include "plenoflame/sampling/philox.h"
#include "render/forward/forward_chunk.h"
#include "render/forward/forward_pixels.h"
#include "render/forward/forward_surfaces.h"
#include "render/run/run_control.h"
#include "render/run/run_progress.h"
#include "render/transport/emission_proposal.h"
#include "render/visibility/aperture_cone.h"

namespace plenoflame {
namespace {

/// Approximate number of bundles that one thread traces at a time. The number is smaller if each
/// bundle is scattered to the camera from many places.
constexpr std::int64_t kChunkBundles = 32768, kScatteredBundles = 8192;
constexpr double kSettled = 1.3;     ///< largest growth of a settled estimate between rounds
constexpr int kChunksPerThread = 8;  ///< chunks between two merges
/// The emission is sampled with numbers that no bundle uses.
constexpr std::uint64_t kProposalSeed = 0x70726f706f73616cu;

using Clock = std::chrono::steady_clock;

/// A bundle that arrived on a pixel of the window, before attenuation.
struct Hit {
  int column, row, replicate;
  Vec3 origin, direction;  ///< world, from the flame to the camera
  double weight;           ///< [m^3 sr] per unit of emission
  int pupil_part;          ///< part of the stop that it passed
};

class BundleTracer : public BundleSource {
 public:
  BundleTracer(const CompiledScene& scene, const RenderSettings& settings, const Film& film,
               const EmissionProposal& proposal)
      : scene_(scene),
        settings_(settings),
        pixels_(scene.camera, film.window(), settings.seed),
        proposal_(proposal),
        cone_(scene.camera),
        to_camera_(scene.camera.to_world().inverse()) {}

  void trace(std::int64_t first, std::int64_t end, ForwardChunk& chunk) const override;

 private:
  void trace_bundle(std::int64_t index, std::vector<Camera::Arrival>& arrivals,
                    std::vector<Hit>& hits, ForwardChunk& chunk) const;
  void attenuate(const Hit* hits, int count, ForwardChunk& chunk) const;

  const CompiledScene& scene_;
  const RenderSettings& settings_;
  ForwardPixels pixels_;
  const EmissionProposal& proposal_;
  ApertureCone cone_;
  RigidTransform to_camera_;
};

void BundleTracer::trace_bundle(std::int64_t index, std::vector<Camera::Arrival>& arrivals,
                                std::vector<Hit>& hits, ForwardChunk& chunk) const {
  const auto a = philox(settings_.seed, static_cast<std::uint64_t>(index), 0);
  const auto b = philox(settings_.seed, static_cast<std::uint64_t>(index), 1);
  const EmissionProposal::Point point = proposal_.draw(unit_uniform(a[0], a[1]), unit_uniform(b[0]),
                                                       unit_uniform(b[1]), unit_uniform(b[2]));
  const Vec3 origin = to_camera_.point(point.position);
  if (!cone_.in_front(origin)) return;
  const ApertureCone::Direction way = cone_.draw(origin, unit_uniform(a[2]), unit_uniform(a[3]));
  if (!(way.solid_angle > 0)) return;
  arrivals.clear();
  scene_.camera.trace_from_scene({origin, way.direction}, arrivals);
  for (std::size_t k = 0; k < arrivals.size(); ++k) {
    const Camera::Arrival& arrival = arrivals[k];
    const auto pixel = pixels_.find(arrival.sensor_point, index, k, chunk.work.rays_reached);
    if (!pixel) continue;
    hits.push_back({pixel->column, pixel->row, static_cast<int>(index % settings_.replicates),
                    point.position, scene_.camera.to_world().direction(way.direction),
                    way.solid_angle * arrival.etendue_ratio / point.density, arrival.pupil_part});
  }
}

void BundleTracer::attenuate(const Hit* hits, int count, ForwardChunk& chunk) const {
  const Medium& medium = *scene_.medium;
  const Box box = medium.bounds();
  const int padded = (count + kRayPadding - 1) / kRayPadding * kRayPadding;
  constexpr int kArrays = 8;
  struct alignas(64) Arrays {
    double value[kArrays][kMaxBatch];
  };
  const auto arrays = std::make_unique<Arrays>();
  auto& v = arrays->value;
  RayBatch<double> rays;
  rays.size = padded;
  rays.anchor = 0.5 * (box.lower + box.upper);
  for (int i = 0; i < padded; ++i) {
    const Hit& hit = hits[std::min(i, count - 1)];
    const Vec3 p = hit.origin - rays.anchor;
    v[0][i] = p.x, v[1][i] = p.y, v[2][i] = p.z;
    v[3][i] = hit.direction.x, v[4][i] = hit.direction.y, v[5][i] = hit.direction.z;
    v[6][i] = 0;
    v[7][i] = std::numeric_limits<double>::infinity();
  }
  rays.x = v[0], rays.y = v[1], rays.z = v[2];
  rays.dx = v[3], rays.dy = v[4], rays.dz = v[5];
  rays.t_near = v[6], rays.t_far = v[7];
  const auto channels = static_cast<std::size_t>(medium.channel_count());
  std::vector<double> emission(channels);
  // The integrator also returns the radiance of the path; only the transmittance is needed.
  const std::size_t stride = kMaxBatch, passes = medium.is_grey() ? 1 : channels;
  std::vector<double> results((channels + passes) * stride + 8);
  RadianceBatch<double> out;
  void* aligned = results.data();
  std::size_t space = results.size() * sizeof(double);
  out.radiance = static_cast<double*>(
      std::align(64, (channels + passes) * stride * sizeof(double), aligned, space));
  out.stride = kMaxBatch;
  out.transmittance = out.radiance + channels * stride;
  out.transmittance_stride = passes > 1 ? kMaxBatch : 0;
  MediumOptions options;
  options.isa = settings_.isa;
  options.skip = settings_.skip;
  medium.integrate(rays, options, out, chunk.work.medium);
  for (int i = 0; i < count; ++i) {
    medium.coefficients(hits[i].origin, emission.data());
    bool any = false;
    for (std::size_t c = 0; c < channels; ++c) {
      emission[c] *= hits[i].weight *
                     out.transmittance[(passes > 1 ? c * stride : 0) + static_cast<std::size_t>(i)];
      any = any || emission[c] > 0;
    }
    if (!any) continue;
    chunk.deposits.push_back({hits[i].column, hits[i].row, hits[i].replicate});
    append_channels(scene_, emission.data(), hits[i].pupil_part, chunk.flux);
  }
}

void BundleTracer::trace(std::int64_t first, std::int64_t end, ForwardChunk& chunk) const {
  auto start = Clock::now();
  std::vector<Hit> hits;
  std::vector<Camera::Arrival> arrivals;
  for (std::int64_t i = first; i < end; ++i) trace_bundle(i, arrivals, hits, chunk);
  chunk.work.rays = static_cast<double>(end - first);
  chunk.work.stages.optics = seconds_since(start);
  start = Clock::now();
  for (std::size_t i = 0; i < hits.size(); i += kMaxBatch)
    attenuate(hits.data() + i, static_cast<int>(std::min<std::size_t>(kMaxBatch, hits.size() - i)),
              chunk);
  chunk.work.stages.medium = seconds_since(start);
  chunk.done = true;
}

/// Adds a chunk to film and statistics.
void merge(const ForwardChunk& chunk, Film& film, RenderStatistics& statistics) {
  const auto channels = static_cast<std::size_t>(film.channels());
  for (std::size_t i = 0; i < chunk.deposits.size(); ++i) {
    const ForwardDeposit& d = chunk.deposits[i];
    for (std::size_t c = 0; c < channels; ++c)
      film.sum(static_cast<int>(c), d.replicate, d.column, d.row) += chunk.flux[i * channels + c];
  }
  statistics += chunk.work;
}

/// Traces bundles in chunks of whole points (one bundle of every replicate). Any number of leading
/// chunks is therefore a valid, smaller run. Chunks are merged in order, so that the sums do not
/// depend on the distribution over threads.
class Run {
 public:
  /// @param bundles approximate number per chunk
  Run(const BundleSource& tracer, std::int64_t bundles, const RenderSettings& settings,
      const Execution& execution, Film& film, RenderStatistics& statistics)
      : tracer_(tracer),
        bundles_(bundles),
        settings_(settings),
        execution_(execution),
        film_(film),
        statistics_(statistics),
        checkpoints_(settings),
        progress_(execution, settings.time_limit),
        done_(static_cast<std::int64_t>(film.tile_samples(0))) {}

  /// Continues until the film holds `points` of each replicate, the total number.
  /// @return false when stopped
  bool trace_all(std::int64_t points) {
    foresee(points);
    return trace_until(points);
  }
  /// Continues until the film holds `points` of each replicate. @return false when stopped
  bool trace_until(std::int64_t points);
  /// Continues until the stated error is below the target, with at most `points`.
  void trace_to_target(std::int64_t points);
  std::int64_t done() const { return done_; }
  void complete() { progress_.complete(); }
  std::int64_t per_chunk() const {
    return std::max<std::int64_t>(1, bundles_ / settings_.replicates);
  }
  StatedError error() const {
    const FilmImages images = film_.images(0, execution_);
    return stated_error(images.flux, images.standard_error, film_.replicates(), film_.lit_parts(),
                        execution_);
  }

 private:
  void foresee(std::int64_t points) {
    progress_.foresee(static_cast<double>(done_),
                      static_cast<double>(std::max<std::int64_t>(points - done_, 0)));
  }

  const BundleSource& tracer_;
  std::int64_t bundles_;
  const RenderSettings& settings_;
  const Execution& execution_;
  Film& film_;
  RenderStatistics& statistics_;
  Checkpoints checkpoints_;
  RunProgress progress_;
  std::int64_t done_;
};

bool Run::trace_until(std::int64_t points) {
  const std::int64_t last = (points + per_chunk() - 1) / per_chunk();
  const std::int64_t round =
      static_cast<std::int64_t>(kChunksPerThread) * execution_.thread_count();
  std::vector<ForwardChunk> pending;
  for (bool complete = true; done_ < points;) {
    if (!complete) return false;
    const std::int64_t first = done_ / per_chunk();
    pending.assign(static_cast<std::size_t>(std::min(round, last - first)), {});
    complete = parallel_for(execution_, pending.size(), [&](std::size_t i, int) {
      const std::int64_t begin = (first + static_cast<std::int64_t>(i)) * per_chunk();
      tracer_.trace(std::max(begin, done_) * settings_.replicates,
                    std::min(begin + per_chunk(), points) * settings_.replicates, pending[i]);
    });
    const std::int64_t before = done_;
    const double rays_before = statistics_.rays;
    for (std::size_t i = 0; i < pending.size() && pending[i].done; ++i) {
      merge(pending[i], film_, statistics_);
      done_ = std::min((first + static_cast<std::int64_t>(i) + 1) * per_chunk(), points);
    }
    for (int t = 0; t < film_.tile_count(); ++t)
      film_.add_samples(t, static_cast<double>(done_ - before));
    checkpoints_.offer(film_);
    progress_.add(static_cast<double>(done_ - before), statistics_.rays - rays_before);
  }
  return true;
}

void Run::trace_to_target(std::int64_t points) {
  // Only the film decides how long to continue, and only at the ends of rounds. A resumed run
  // therefore makes the same decisions as an uninterrupted one. The film keeps the goal of a round,
  // so that a stopped round is completed first.
  const auto goal = [&] {
    return film_.tile_goals().empty() ? 0 : static_cast<std::int64_t>(film_.tile_goals().front());
  };
  if (goal() > done_ && !trace_all(std::min(goal(), points))) return;
  double foreseen_before = 0;
  while (done_ < points) {
    double growth = 2;
    std::int64_t foreseen = settings_.target_error > 0 ? 0 : points;  // 0: unknown
    double least = 0;  // lower estimate of the number that is needed
    if (done_ > 0) {
      const StatedError now = error();
      statistics_.relative_error = now.relative_rmse;
      progress_.set_relative_error(now.relative_rmse);
      if (settings_.target_error > 0 && now.relative_rmse > 0) {
        if (now.bound <= settings_.target_error) return;
        // Errors decrease with the square root of the number of bundles.
        growth = 1.02 * std::pow(now.bound / settings_.target_error, 2);
        const double all = growth * static_cast<double>(done_);
        // As long as the picture gains lit pixels, each estimate exceeds the one before. The rise
        // per doubling of the bundles tells how much the estimate will still grow.
        const double before = std::exchange(foreseen_before, all);
        const double rise = before > 0 ? std::max(1.0, all / before) : kSettled;
        least = std::min(all * rise, static_cast<double>(points));
        if (before > 0 && rise < kSettled) foreseen = static_cast<std::int64_t>(least);
      }
    }
    const double whole = std::ceil(static_cast<double>(std::max(done_, 2 * per_chunk())) *
                                   std::clamp(growth, 1.1, 2.0) / static_cast<double>(per_chunk()));
    const auto next = std::min(static_cast<std::int64_t>(whole) * per_chunk(), points);
    film_.tile_goals().assign(static_cast<std::size_t>(film_.tile_count()),
                              static_cast<double>(next));
    if (foreseen > 0)
      foresee(std::max(foreseen, next));
    else
      progress_.explore(static_cast<double>(next - done_),
                        least > 0 ? static_cast<double>(next) / (kSettled * least) : 0);
    if (!trace_until(next)) return;
  }
}

/// Returns nullptr if everything is dark.
std::unique_ptr<BundleSource> make_bundles(const CompiledScene& scene,
                                           const RenderSettings& settings, const Film& film,
                                           const EmissionProposal* proposal,
                                           const std::stop_token& stop) {
  if (!scene.surfaces && scene.lights.environment.empty() && scene.scatterers.empty() &&
      !scene.windows)
    return proposal ? std::make_unique<BundleTracer>(scene, settings, film, *proposal) : nullptr;
  auto bundles = std::make_unique<SurfaceBundles>(scene, settings, film, proposal, stop);
  return bundles->dark() ? nullptr : std::move(bundles);
}

/// Bundles of all spectral paths: each bundle is traced once for every path.
class PathBundles : public BundleSource {
 public:
  PathBundles(const CompiledScene& scene, const RenderSettings& settings, const Film& film,
              const Execution& execution)
      : channels_(static_cast<std::size_t>(film.channels())) {
    for (const CompiledScene& path : scene.paths()) {
      Path made;
      made.channels = path.film_channel;
      if (path.medium)
        made.proposal = std::make_unique<EmissionProposal>(
            *path.medium, settings.seed ^ kProposalSeed, execution);
      if (made.proposal && made.proposal->dark()) made.proposal.reset();
      made.bundles = make_bundles(path, settings, film, made.proposal.get(), execution.stop);
      if (made.bundles) paths_.push_back(std::move(made));
    }
  }
  bool dark() const { return paths_.empty(); }
  void trace(std::int64_t first, std::int64_t end, ForwardChunk& chunk) const override {
    // There is a single path, whose channels are the film's.
    if (paths_.front().channels.empty()) return paths_.front().bundles->trace(first, end, chunk);
    for (const Path& path : paths_) {
      ForwardChunk own;
      path.bundles->trace(first, end, own);
      if (!own.done) return;
      const auto channel = static_cast<std::size_t>(path.channels.front());
      for (std::size_t i = 0; i < own.deposits.size(); ++i) {
        chunk.deposits.push_back(own.deposits[i]);
        chunk.flux.resize(chunk.flux.size() + channels_);
        chunk.flux[chunk.flux.size() - channels_ + channel] = own.flux[i];
      }
      chunk.work += own.work;
      chunk.most_waiting = std::max(chunk.most_waiting, own.most_waiting);
    }
    chunk.done = true;
  }

 private:
  struct Path {
    std::vector<int> channels;  ///< the film's channel for each of the path's; empty: the same
    std::unique_ptr<EmissionProposal> proposal;
    std::unique_ptr<BundleSource> bundles;
  };
  std::size_t channels_;
  std::vector<Path> paths_;
};

}  // namespace

void render_forward(const CompiledScene& scene, const RenderSettings& settings,
                    const Execution& execution, Film& film, RenderStatistics& statistics) {
  statistics.precision = "double";
  const auto start = Clock::now();
  const std::int64_t points =
      (static_cast<std::int64_t>(settings.samples) + settings.replicates - 1) / settings.replicates;
  const PathBundles bundles(scene, settings, film, execution);
  statistics.stages.generate += seconds_since(start) * execution.thread_count();
  if (bundles.dark()) {
    for (int t = 0; t < film.tile_count(); ++t)
      film.add_samples(t, static_cast<double>(points) - film.tile_samples(t));
    return;
  }
  const bool open_ended = settings.target_error > 0 || settings.time_limit > 0;
  const Deadline deadline(execution.stop, settings.time_limit);
  Execution inner = execution;
  inner.stop = deadline.token();
  Run run(bundles, scene.paths().front().scatterers.empty() ? kChunkBundles : kScatteredBundles,
          settings, inner, film, statistics);
  if (open_ended)
    run.trace_to_target(points);
  else
    run.trace_all(points);
  // The end of a time limit is no interruption.
  statistics.complete = open_ended ? !execution.stop.stop_requested() : run.done() == points;
  if (statistics.complete) run.complete();
  if (settings.target_error > 0) {
    const StatedError error = run.error();
    statistics.target_reached = error.relative_rmse > 0 && error.bound <= settings.target_error;
  }
}

}  // namespace plenoflame
