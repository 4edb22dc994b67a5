#include "render/forward.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "film/image_sums.h"
#include "plenoflame/sampling/philox.h"
#include "render/aperture_cone.h"
#include "render/emission_proposal.h"
#include "render/forward_chunk.h"
#include "render/forward_surfaces.h"
#include "render/run_control.h"

namespace plenoflame {
namespace {

/// About so many are traced by one thread at a time; fewer where each is scattered to the camera
/// from many places.
constexpr std::int64_t kChunkBundles = 32768, kScatteredBundles = 8192;
constexpr int kChunksPerThread = 8;  ///< between two merges
/// The lookups of the emission must not be numbers that bundles use.
constexpr std::uint64_t kProposalSeed = 0x70726f706f73616cu;

using Clock = std::chrono::steady_clock;

/// A bundle that arrived on a pixel of the window, before attenuation.
struct Hit {
  int column, row, replicate;
  Vec3 origin, direction;  ///< world, from the flame to the camera
  double weight;           ///< [m^3 sr] per unit of emission
};

class BundleTracer : public BundleSource {
 public:
  BundleTracer(const CompiledScene& scene, const RenderSettings& settings, const Film& film,
               const EmissionProposal& proposal)
      : scene_(scene),
        settings_(settings),
        window_(film.window()),
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
  PixelWindow window_;
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
  const SensorSpec& sensor = scene_.camera.spec().sensor;
  for (const Camera::Arrival& arrival : arrivals) {
    const double x = 0.5 * sensor.columns - arrival.sensor_point.x / sensor.pixel_pitch;
    const double y = 0.5 * sensor.rows - arrival.sensor_point.y / sensor.pixel_pitch;
    if (!(x >= 0 && x < sensor.columns && y >= 0 && y < sensor.rows)) continue;
    chunk.arrived += 1;
    const int column = static_cast<int>(x), row = static_cast<int>(y);
    if (column < window_.x || column >= window_.x + window_.width || row < window_.y ||
        row >= window_.y + window_.height)
      continue;
    hits.push_back({column, row, static_cast<int>(index % settings_.replicates), point.position,
                    scene_.camera.to_world().direction(way.direction),
                    way.solid_angle * arrival.etendue_ratio / point.density});
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
  // The integrator gives the radiance of the way as well; only the transmittance is wanted.
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
  medium.integrate(rays, options, out, chunk.medium);
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
    append_channels(scene_, emission.data(), chunk.flux);
  }
}

void BundleTracer::trace(std::int64_t first, std::int64_t end, ForwardChunk& chunk) const {
  auto start = Clock::now();
  std::vector<Hit> hits;
  std::vector<Camera::Arrival> arrivals;
  for (std::int64_t i = first; i < end; ++i) trace_bundle(i, arrivals, hits, chunk);
  chunk.bundles = static_cast<double>(end - first);
  chunk.seconds_optics = seconds_since(start);
  start = Clock::now();
  for (std::size_t i = 0; i < hits.size(); i += kMaxBatch)
    attenuate(hits.data() + i, static_cast<int>(std::min<std::size_t>(kMaxBatch, hits.size() - i)),
              chunk);
  chunk.seconds_medium = seconds_since(start);
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
  statistics.rays += chunk.bundles;
  statistics.rays_reached += chunk.arrived;
  statistics.seconds_optics += chunk.seconds_optics;
  statistics.seconds_medium += chunk.seconds_medium;
  statistics.seconds_surfaces += chunk.seconds_surfaces;
  statistics.medium += chunk.medium;
}

/// Traces bundles in chunks: whole numbers of points (one bundle of every replicate), so that any
/// number of leading chunks is a valid, smaller run. Chunks are merged in order: the sums do not
/// depend on who traced what.
class Run {
 public:
  /// @param bundles of a chunk, about
  Run(const BundleSource& tracer, std::int64_t bundles, const RenderSettings& settings,
      const Execution& execution, Film& film, RenderStatistics& statistics)
      : tracer_(tracer),
        bundles_(bundles),
        settings_(settings),
        execution_(execution),
        film_(film),
        statistics_(statistics),
        checkpoints_(settings),
        done_(static_cast<std::int64_t>(film.tile_samples(0))) {}

  /// Goes on until the film holds `points` of each replicate. @return false when stopped
  bool trace_until(std::int64_t points, bool keep_parts);
  /// Goes on until the stated error is below the target, at most to `points`.
  void trace_to_target(std::int64_t points);
  std::int64_t done() const { return done_; }
  std::int64_t per_chunk() const {
    return std::max<std::int64_t>(1, bundles_ / settings_.replicates);
  }
  StatedError error() const {
    const FilmImages images = film_.images(0, execution_);
    return stated_error(images.flux, images.standard_error, film_.replicates(), film_.lit_parts(),
                        execution_);
  }

 private:
  void report(std::int64_t points) const;

  const BundleSource& tracer_;
  std::int64_t bundles_;
  const RenderSettings& settings_;
  const Execution& execution_;
  Film& film_;
  RenderStatistics& statistics_;
  Checkpoints checkpoints_;
  std::int64_t done_;
  Clock::time_point start_ = Clock::now();
};

void Run::report(std::int64_t points) const {
  if (!execution_.progress) return;
  Progress progress;
  const double elapsed = seconds_since(start_);
  progress.fraction = static_cast<double>(done_) / static_cast<double>(points);
  progress.rays = statistics_.rays;
  progress.rays_per_second = statistics_.rays / elapsed;
  progress.relative_error = statistics_.relative_error;
  if (done_ > 0) progress.remaining_seconds = elapsed * (1 / progress.fraction - 1);
  execution_.progress(progress);
}

bool Run::trace_until(std::int64_t points, bool keep_parts) {
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
    for (std::size_t i = 0; i < pending.size() && pending[i].done; ++i) {
      merge(pending[i], film_, statistics_);
      done_ = std::min((first + static_cast<std::int64_t>(i) + 1) * per_chunk(), points);
    }
    for (int t = 0; t < film_.tile_count(); ++t)
      film_.add_samples(t, static_cast<double>(done_ - before));
    if (keep_parts) checkpoints_.offer(film_);
    report(points);
  }
  return true;
}

void Run::trace_to_target(std::int64_t points) {
  // The film alone decides how far to go, at the ends of rounds only: a run that goes on from there
  // does what the first would have done.
  // What a round was to reach is kept with the film: one that was stopped is ended first.
  const auto goal = [&] {
    return film_.tile_goals().empty() ? 0 : static_cast<std::int64_t>(film_.tile_goals().front());
  };
  if (goal() > done_ && !trace_until(std::min(goal(), points), true)) return;
  while (done_ < points) {
    double growth = 2;
    if (done_ > 0) {
      const StatedError now = error();
      statistics_.relative_error = now.relative_rmse;
      if (settings_.target_error > 0) {
        if (now.relative_rmse > 0 && now.bound <= settings_.target_error) return;
        // Errors fall with the root of the number of bundles.
        growth = 1.02 * std::pow(now.bound / settings_.target_error, 2);
        if (!(now.relative_rmse > 0)) growth = 2;  // nothing has arrived yet
      }
    }
    const double whole = std::ceil(static_cast<double>(std::max(done_, 2 * per_chunk())) *
                                   std::clamp(growth, 1.1, 2.0) / static_cast<double>(per_chunk()));
    const auto next = static_cast<std::int64_t>(whole) * per_chunk();
    film_.tile_goals().assign(static_cast<std::size_t>(film_.tile_count()),
                              static_cast<double>(std::min(next, points)));
    if (!trace_until(std::min(next, points), true)) return;
  }
}

/// Bundles of a scene that disperses: each goes its way once for every wavelength.
class DispersedBundles : public BundleSource {
 public:
  DispersedBundles(std::size_t channels) : channels_(channels) {}
  void add(std::unique_ptr<EmissionProposal> proposal, std::unique_ptr<BundleSource> bundles,
           int channel) {
    proposals_.push_back(std::move(proposal));
    parts_.push_back({std::move(bundles), static_cast<std::size_t>(channel)});
  }
  bool dark() const { return parts_.empty(); }
  void trace(std::int64_t first, std::int64_t end, ForwardChunk& chunk) const override {
    for (const Part& part : parts_) {
      ForwardChunk own;
      part.bundles->trace(first, end, own);
      if (!own.done) return;
      for (std::size_t i = 0; i < own.deposits.size(); ++i) {
        chunk.deposits.push_back(own.deposits[i]);
        chunk.flux.resize(chunk.flux.size() + channels_);
        chunk.flux[chunk.flux.size() - channels_ + part.channel] = own.flux[i];
      }
      chunk.bundles += own.bundles;
      chunk.arrived += own.arrived;
      chunk.seconds_optics += own.seconds_optics;
      chunk.seconds_medium += own.seconds_medium;
      chunk.seconds_surfaces += own.seconds_surfaces;
      chunk.medium += own.medium;
      chunk.most_waiting = std::max(chunk.most_waiting, own.most_waiting);
    }
    chunk.done = true;
  }

 private:
  struct Part {
    std::unique_ptr<BundleSource> bundles;
    std::size_t channel;
  };
  std::size_t channels_;
  std::vector<std::unique_ptr<EmissionProposal>> proposals_;
  std::vector<Part> parts_;
};

/// Nothing when everything is dark.
std::unique_ptr<BundleSource> make_bundles(const CompiledScene& scene,
                                           const RenderSettings& settings, const Film& film,
                                           const EmissionProposal* proposal,
                                           const std::stop_token& stop) {
  if (!scene.surfaces && scene.lights.environment.empty() && scene.scatterers.empty())
    return proposal ? std::make_unique<BundleTracer>(scene, settings, film, *proposal) : nullptr;
  auto bundles = std::make_unique<SurfaceBundles>(scene, settings, film, proposal, stop);
  return bundles->dark() ? nullptr : std::move(bundles);
}

}  // namespace

void render_forward(const CompiledScene& scene, const RenderSettings& settings,
                    const Execution& execution, Film& film, RenderStatistics& statistics) {
  statistics.precision = "double";
  const auto start = Clock::now();
  const std::int64_t points =
      (static_cast<std::int64_t>(settings.samples) + settings.replicates - 1) / settings.replicates;
  const auto proposal_of = [&](const CompiledScene& part) {
    std::unique_ptr<EmissionProposal> proposal;
    if (part.medium)
      proposal = std::make_unique<EmissionProposal>(*part.medium, settings.seed ^ kProposalSeed,
                                                    execution);
    if (proposal && proposal->dark()) proposal.reset();
    return proposal;
  };
  std::unique_ptr<EmissionProposal> proposal;
  std::unique_ptr<BundleSource> tracer;
  if (scene.parts.empty()) {
    proposal = proposal_of(scene);
    statistics.seconds_generate += seconds_since(start) * execution.thread_count();
    tracer = make_bundles(scene, settings, film, proposal.get(), execution.stop);
  } else {
    auto all = std::make_unique<DispersedBundles>(static_cast<std::size_t>(film.channels()));
    for (const CompiledScene& part : scene.parts) {
      std::unique_ptr<EmissionProposal> own = proposal_of(part);
      std::unique_ptr<BundleSource> bundles =
          make_bundles(part, settings, film, own.get(), execution.stop);
      if (bundles) all->add(std::move(own), std::move(bundles), part.film_channel.front());
    }
    if (!all->dark()) tracer = std::move(all);
  }
  if (!tracer) {
    for (int t = 0; t < film.tile_count(); ++t)
      film.add_samples(t, static_cast<double>(points) - film.tile_samples(t));
    return;
  }
  const bool open_ended = settings.target_error > 0 || settings.time_limit > 0;
  const Deadline deadline(execution.stop, settings.time_limit);
  Execution inner = execution;
  inner.stop = deadline.token();
  const auto& media = scene.parts.empty() ? scene : scene.parts.front();
  Run run(*tracer, media.scatterers.empty() ? kChunkBundles : kScatteredBundles, settings, inner,
          film, statistics);
  if (open_ended)
    run.trace_to_target(points);
  else
    run.trace_until(points, true);
  // A time limit that ran out is no interruption: what is there is what was asked for.
  statistics.complete = open_ended ? !execution.stop.stop_requested() : run.done() == points;
  if (settings.target_error > 0) {
    const StatedError error = run.error();
    statistics.target_reached = error.relative_rmse > 0 && error.bound <= settings.target_error;
  }
}

}  // namespace plenoflame
