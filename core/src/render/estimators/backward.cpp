#include "render/estimators/backward.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "base/isa_dispatch.h"
#include "plenoflame/base/error.h"
#include "render/run/run_control.h"
#include "render/tracer/picture_tracer.h"
#include "render/transport/channel_sum.h"
#include "render/transport/scene_medium.h"

namespace plenoflame {
namespace {

constexpr int kLevels = 7;  ///< of fewer points, each with half of the points before
/// The same if later parts continue the sequences: every part needs points on every level.
constexpr int kPartLevels = 5;
constexpr int kLeastPoints = 1;    ///< points of a replicate on the last level
constexpr int kPartEntries = 256;  ///< entries of a pool whose sequences are continued

Execution alone() {
  Execution execution;
  execution.threads = 1;
  return execution;
}

/// Largest distance from a microlens' centre to the middles of pixels that record its light [m],
/// except for half a pixel.
double micro_image_reach(const CompiledScene& scene) {
  double reach = 0;
  for (const PupilTable& table : scene.pupils.tables())
    for (const PupilNode& node : table.nodes)
      if (!node.dark()) reach = std::max(reach, std::fabs(node.centre) + node.outer_radius);
  const Vec2 beside = scene.camera.spec().sensor.blur_reach();
  return reach + std::max(beside.x, beside.y);
}

/// Largest displacement of microlenses over the sensor by a tilt [m].
double shift_by_tilt(const Camera& camera) {
  const double corner = camera.spec().sensor.corner();
  const double tilt = length(camera.spec().array.tilt);
  return 1.5 * tilt * (tilt * corner + camera.array_front() - camera.sensor());
}

std::shared_ptr<const SobolPools> make_pools(const RenderSettings& settings,
                                             const PointRange& range,
                                             const Execution& execution = alone()) {
  const std::uint32_t first = range.first;
  const int points = range.points;
  const bool part = range.part;
  int levels = 1;
  while (levels < (part ? kPartLevels : kLevels) && points >> levels >= kLeastPoints) ++levels;
  std::vector<std::optional<SobolPool>> made(static_cast<std::size_t>(levels));
  parallel_for(execution, made.size(), [&](std::size_t level, int) {
    made[level].emplace(settings.replicates, points >> level, first >> level,
                        mix64(settings.seed + level), 0, part ? kPartEntries : 0);
  });
  auto pools = std::make_shared<SobolPools>();
  for (auto& pool : made) pools->push_back(std::move(*pool));
  return pools;
}

/// Tells whether the medium alone lights rays, along their whole lines.
bool takes_lines(const CompiledScene& scene, const PathLight& light) {
  return !scene.windows && !light.surfaces && !light.scatter;
}

/// The plans of a range, one for each path.
template <class Real>
using PathPlans = std::vector<std::unique_ptr<const BackwardPlan<Real>>>;

/// The tracer of one thread. It belongs to a plan until jobs of another plan arrive.
template <class Real>
class Tracer {
 public:
  PictureTracer<Real>& of(const BackwardPlan<Real>& plan, Film& film) {
    if (&plan != plan_) {
      if (current_) counters_ += current_->counters();
      current_ = std::make_unique<PictureTracer<Real>>(plan, film);
      plan_ = &plan;
    }
    return *current_;
  }
  WorkCounters counters() const {
    WorkCounters all = counters_;
    if (current_) all += current_->counters();
    return all;
  }

 private:
  const BackwardPlan<Real>* plan_ = nullptr;
  std::unique_ptr<PictureTracer<Real>> current_;
  WorkCounters counters_;  ///< counts of earlier tracers
};

/// Runs jobs with all threads of an execution until none is left, one throws, or a stop is
/// requested.
void run_jobs(const NextTile& next, const Execution& execution,
              const std::function<void(const TileJob& job, int worker)>& run) {
  std::atomic<bool> failed{false};
  parallel_for(execution, static_cast<std::size_t>(execution.thread_count()),
               [&](std::size_t, int worker) {
                 try {
                   while (!failed && !execution.stop.stop_requested()) {
                     const std::optional<TileJob> job = next();
                     if (!job) return;
                     run(*job, worker);
                   }
                 } catch (...) {
                   failed = true;
                   throw;
                 }
               });
}

template <class Real>
void run_plans(const std::vector<PathPlans<Real>>& plans, const NextTile& next,
               const Execution& execution, Film& film, RenderStatistics& statistics,
               const TileDone& tile_done) {
  const auto workers = static_cast<std::size_t>(execution.thread_count());
  std::vector<Tracer<Real>> tracers(workers);
  const auto start = std::chrono::steady_clock::now();
  std::mutex mutex;
  std::size_t done = 0;
  run_jobs(next, execution, [&](const TileJob& job, int number) {
    const auto worker = static_cast<std::size_t>(number);
    const PathPlans<Real>& paths = plans[job.range];
    double new_rays = 0;
    for (const auto& path : paths) {
      PictureTracer<Real>& tracer = tracers[worker].of(*path, film);
      new_rays -= tracer.rays();
      tracer.render(job.tile);
      new_rays += tracer.rays();
    }
    film.add_samples(job.tile, paths.front()->points.points);
    const std::lock_guard lock(mutex);
    ++done;
    if (tile_done) tile_done(job, new_rays);
  });
  WorkCounters work;
  for (const auto& tracer : tracers) work += tracer.counters();
  work.tiles = static_cast<double>(done);
  const StageSeconds& stages = work.stages;
  work.stages.generate = std::max(0.0, seconds_since(start) * static_cast<double>(workers) -
                                           stages.optics - stages.medium - stages.surfaces);
  statistics += work;
}

}  // namespace

template <class Real>
BackwardKernels<Real> backward_kernels(Isa isa) {
  PLENOFLAME_DISPATCH(isa, return {kernels::generate, kernels::multiply, kernels::add_neighbours,
                                   kernels::sum, kernels::set_up_rows};)
}
template BackwardKernels<float> backward_kernels<float>(Isa);
template BackwardKernels<double> backward_kernels<double>(Isa);

template <class Real>
BackwardPlan<Real> make_pass_plan(const CompiledScene& scene, const Medium& medium,
                                  const RenderSettings& settings, const PointRange& range,
                                  const PathLight& light, std::shared_ptr<const SobolPools> pools) {
  if (!pools) pools = make_pools(settings, range);
  BackwardPlan<Real> plan;
  plan.scene = &scene;
  plan.medium = &medium;
  plan.settings = &settings;
  plan.scatter = light.scatter.get();
  plan.points = range;
  plan.kernels = backward_kernels<Real>(settings.isa);
  plan.optics = camera_kernels<Real>(settings.isa);
  const Camera& camera = scene.camera;
  const Box box = medium.bounds();
  plan.anchor = 0.5 * (box.lower + box.upper);
  const Vec3 anchor = camera.to_world().inverse().point(plan.anchor);
  plan.camera = kernel_camera<Real>(camera, anchor, camera.to_world());
  plan.microlenses = kernel_microlenses<Real>(camera);
  if (const auto& between = scene.pupils.between()) {
    plan.between_type = static_cast<int>(plan.microlenses.size());
    plan.microlenses.push_back(kernel_microlenses<Real>(between->camera).front());
    plan.between_z = static_cast<Real>(between->camera.aim_plane(0) - camera.array_front());
  }
  plan.pools_of_range = std::move(pools);
  for (std::size_t level = 0; level < plan.pools().size(); ++level) {
    const SobolPool& pool = plan.pools()[level];
    plan.levels.push_back(
        {&pool, static_cast<int>(level),
         static_cast<double>(plan.pools().front().points()) / static_cast<double>(pool.points()),
         log2_points_of(pool.points())});
  }
  const Vec2 pixel = camera.spec().sensor.pixel();
  if (camera.has_array())
    for (const PupilTable& table : scene.pupils.tables())
      plan.worths.emplace_back(table, 0.5 * std::max(pixel.x, pixel.y));
  if (camera.has_array()) plan.reach = micro_image_reach(scene);
  if (camera.array_tilted()) plan.reach += shift_by_tilt(camera);
  if (const double blur = camera.spec().sensor.blur; blur > 0) {
    plan.blur.emplace(blur);
    plan.blur->fill(plan.blur_of_pixels);
  }
  if (light.surfaces)
    plan.surfaces =
        std::make_unique<BackwardSurfacePlan>(*light.surfaces, settings, range.first, plan.pools());
  plan.takes_lines = takes_lines(scene, light);
  return plan;
}
template BackwardPlan<float> make_pass_plan<float>(const CompiledScene&, const Medium&,
                                                   const RenderSettings&, const PointRange&,
                                                   const PathLight&,
                                                   std::shared_ptr<const SobolPools>);
template BackwardPlan<double> make_pass_plan<double>(const CompiledScene&, const Medium&,
                                                     const RenderSettings&, const PointRange&,
                                                     const PathLight&,
                                                     std::shared_ptr<const SobolPools>);

void count_lenses(const CompiledScene& scene, const BackwardShared& shared,
                  const PixelWindow& window, RenderStatistics& statistics) {
  const Camera& camera = scene.camera;
  if (!camera.has_array()) return;
  // Lenses of the first path represent all paths: dispersion moves beams by less than their
  // margins.
  const SceneBeams* const beams = shared.paths.front().beams.get();
  const double reach = micro_image_reach(scene);
  const Vec2 margin{reach, reach};
  const Vec2 a = camera.sensor_point(window.x + window.width, window.y + window.height);
  const Vec2 b = camera.sensor_point(window.x, window.y);
  for (const LensIndex lens : camera.lattice().within(a - margin, b + margin)) {
    statistics.lenses += 1;
    if (beams && !beams->lenses().may_meet(camera.lattice().type(lens), camera.lens_place(lens)))
      statistics.lenses_skipped += 1;
  }
}

namespace {

/// Tells whether single precision is accurate enough. The rounding of a ray over the distance to
/// the medium must be well below the size of the medium's features.
bool single_precision_suffices(const CompiledScene& scene) {
  const auto fine = [&](const Box& box, double feature_size) {
    if (box.empty()) return true;
    const double distance = length(0.5 * (box.lower + box.upper) - scene.camera.spec().position);
    // Single precision changes directions by a few units of 6e-8. A ray deviates by 3e-7 of the
    // distance.
    return 3e-7 * distance < 0.02 * feature_size;
  };
  return (!scene.medium || fine(scene.medium->bounds(), scene.medium->feature_size())) &&
         (!scene.surfaces || fine(scene.surfaces->bounds(), scene.surfaces->feature_size()));
}

bool in_single_precision(const CompiledScene& scene, const RenderSettings& settings) {
  return settings.precision == Precision::single_precision ||
         (settings.precision == Precision::automatic && single_precision_suffices(scene));
}

/// Tells whether a test of single pixels may save time. It takes about 10 ms at the start, and as
/// long as a few rays for each pixel at the flame's rim. Only values that all ranks have decide.
bool tests_pixels(const CompiledScene& scene, const RenderSettings& settings, int points) {
  constexpr double kLeastRays = 1e7;
  constexpr int kLeastSamples = 32;
  const SensorSpec& sensor = scene.camera.spec().sensor;
  const PixelWindow& window = settings.window;
  const double pixels = window.width > 0 ? static_cast<double>(window.width) * window.height
                                         : static_cast<double>(sensor.columns) * sensor.rows;
  const int samples = points * settings.replicates;
  return samples >= kLeastSamples && pixels * samples > kLeastRays;
}

/// The radiance table for a scene; nullptr if the settings exclude it or if it would not save time.
std::unique_ptr<RadianceTable> make_radiance_table(const CompiledScene& scene,
                                                   const RenderSettings& settings,
                                                   const PathShared& shared) {
  if (!settings.control_variate || !in_single_precision(scene, settings)) return nullptr;
  if (!scene.medium || !shared.takes_lines) return nullptr;  // the table describes whole lines
  if (!scene.part_mixes.empty()) return nullptr;  // the table ignores where rays cross the stop
  const Box box = scene.medium->bounds();
  MediumOptions options;
  options.isa = settings.isa;
  options.skip = settings.skip;
  const Vec3 anchor = 0.5 * (box.lower + box.upper);
  const Medium& medium = shared.behind_windows ? *shared.behind_windows : *scene.medium;
  if (scene.mix.empty()) return RadianceTable::make(scene.camera, medium, anchor, options);
  // The table holds channels, also if quadrature wavelengths represent them.
  auto sum = std::make_unique<ChannelSum>(medium, scene.mix);
  std::unique_ptr<RadianceTable> table = RadianceTable::make(scene.camera, *sum, anchor, options);
  if (table) table->keep(std::move(sum));
  return table;
}

}  // namespace

BackwardShared::BackwardShared(const CompiledScene& scene, const RenderSettings& settings,
                               const Execution& execution) {
  for (const CompiledScene& path : scene.paths()) {
    PathShared& shared = paths.emplace_back();
    if (settings.skip && has_content(path)) shared.beams = SceneBeams::make(path);
    shared.behind_windows = MediumBehindWindows::make(path);
    shared.light = PathLight(path, settings, execution);
    shared.takes_lines = shared.behind_windows || takes_lines(path, shared.light);
    shared.table = make_radiance_table(path, settings, shared);
  }
}

template <class Real>
void BackwardPass::make_plans(const CompiledScene& scene, const RenderSettings& settings,
                              const std::vector<PointRange>& ranges, const BackwardShared& shared,
                              int threads, Plans<Real>& plans) {
  Execution execution;
  execution.threads = threads;
  // Paths of all wavelengths use the same numbers, so that caches hold them once.
  std::vector<std::shared_ptr<const SobolPools>> pools(ranges.size());
  parallel_for(execution, pools.size(), [&](std::size_t r, int) {
    pools[r] = make_pools(settings, ranges[r], pools.size() == 1 ? execution : alone());
  });
  plans.resize(ranges.size());
  for (auto& paths : plans) paths.resize(media_.size());
  parallel_for(execution, ranges.size() * media_.size(), [&](std::size_t i, int) {
    const std::size_t range = i / media_.size(), p = i % media_.size();
    const PathShared& of_path = shared.paths[p];
    const MediumBehindWindows* const bending = of_path.behind_windows.get();
    auto plan = std::make_unique<BackwardPlan<Real>>(
        make_pass_plan<Real>(scene.paths()[p], bending ? *bending : media_[p]->get(), settings,
                             ranges[range], of_path.light, pools[range]));
    plan->takes_lines = of_path.takes_lines;
    if constexpr (std::is_same_v<Real, float>) plan->table = of_path.table.get();
    plan->beams = of_path.beams.get();
    if (plan->beams && tests_pixels(scene.paths()[p], settings, ranges[range].points))
      plan->pixel_beams = plan->beams->pixels();
    plans[range][p] = std::move(plan);
  });
}

BackwardPass::BackwardPass(const CompiledScene& scene, const RenderSettings& settings,
                           const std::vector<PointRange>& ranges, const BackwardShared& shared,
                           int threads)
    : is_single_(in_single_precision(scene, settings)) {
  for (const CompiledScene& path : scene.paths())
    media_.push_back(std::make_unique<SceneMedium>(path));
  if (is_single_)
    make_plans(scene, settings, ranges, shared, threads, single_);
  else
    make_plans(scene, settings, ranges, shared, threads, double_);
}

BackwardPass::~BackwardPass() = default;

bool BackwardPass::run(const std::vector<TileJob>& jobs, const Execution& execution, Film& film,
                       RenderStatistics& statistics, const TileDone& tile_done) const {
  std::vector<bool> seen(static_cast<std::size_t>(film.tile_count()));
  for (const TileJob& job : jobs) {
    // Otherwise two threads would add to the same sums.
    if (seen[static_cast<std::size_t>(job.tile)])
      throw std::logic_error("a tile comes twice in a pass");
    seen[static_cast<std::size_t>(job.tile)] = true;
  }
  std::atomic<std::size_t> next{0};
  run(
      [&]() -> std::optional<TileJob> {
        const std::size_t index = next.fetch_add(1);
        return index < jobs.size() ? std::optional(jobs[index]) : std::nullopt;
      },
      execution, film, statistics, tile_done);
  return next.load() >= jobs.size();
}

void BackwardPass::run(const NextTile& next, const Execution& execution, Film& film,
                       RenderStatistics& statistics, const TileDone& tile_done) const {
  statistics.precision = is_single_ ? "single" : "double";
  if (is_single_)
    run_plans(single_, next, execution, film, statistics, tile_done);
  else
    run_plans(double_, next, execution, film, statistics, tile_done);
}

}  // namespace plenoflame
