#include "render/backward.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "base/isa_dispatch.h"
#include "plenoflame/base/error.h"
#include "render/backward_tile.h"
#include "render/channel_sum.h"
#include "render/run_control.h"
#include "render/scene_medium.h"

namespace plenoflame {
namespace {

constexpr int kLevels = 7;  ///< of fewer points, each half of the one before
/// The same where others go on with the sequences: every part must have points on every level.
constexpr int kPartLevels = 5;
constexpr int kLeastPoints = 1;  ///< of a replicate on the last level
/// Of so few points stated errors would come out too small: what is dim is often dark by chance.
constexpr int kLeastSparsePoints = 4;
constexpr int kPartEntries = 256;  ///< of a pool whose sequences others go on with

Execution alone() {
  Execution execution;
  execution.threads = 1;
  return execution;
}

/// How far from its microlens' centre any micro-image reaches [m].
double micro_image_reach(const PupilSampling& pupils) {
  double reach = 0;
  for (const PupilTable& table : pupils.tables())
    for (const PupilNode& node : table.nodes)
      if (!node.dark()) reach = std::max(reach, std::fabs(node.centre) + node.outer_radius);
  return reach;
}

/// How far, at most, a tilt moves the places of microlenses over the sensor [m].
double shift_by_tilt(const Camera& camera) {
  const SensorSpec& sensor = camera.spec().sensor;
  const double corner = 0.5 * sensor.pixel_pitch * std::hypot(sensor.columns, sensor.rows);
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

template <class Real>
BackwardPlan<Real> make_plan(const CompiledScene& scene, const Medium& medium,
                             const RenderSettings& settings, const PointRange& range,
                             std::shared_ptr<const SobolPools> pools, const SurfaceLightPlan* light,
                             const ScatterPlan* scatter) {
  const auto [first, points, part] = range;
  BackwardPlan<Real> plan;
  plan.scene = &scene;
  plan.medium = &medium;
  plan.settings = &settings;
  plan.scatter = scatter;
  plan.first = first;
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
  if (!part && points >= kLeastSparsePoints)
    plan.sparse_levels =
        std::clamp(kLevels - static_cast<int>(plan.pools().size()), 0, kMostSparseLevels);
  const auto last = static_cast<int>(plan.pools().size()) - 1;
  for (int level = 0; level <= last + plan.sparse_levels; ++level) {
    const int of_pool = std::min(level, last);
    const SobolPool& pool = plan.pools()[static_cast<std::size_t>(of_pool)];
    const int sparse = level - of_pool;
    plan.levels.push_back({&pool, of_pool, sparse,
                           static_cast<double>(plan.pools().front().points() << sparse) /
                               static_cast<double>(pool.points()),
                           doublings_of(pool.points())});
  }
  if (camera.has_array())
    for (const PupilTable& table : scene.pupils.tables())
      plan.worths.emplace_back(table, 0.5 * camera.spec().sensor.pixel_pitch);
  if (camera.has_array()) plan.reach = micro_image_reach(scene.pupils);
  if (camera.array_tilted()) plan.reach += shift_by_tilt(camera);
  if (light)
    plan.surfaces =
        std::make_unique<BackwardSurfacePlan>(*light, settings, first, plan.pools(), plan.anchor);
  return plan;
}

void add(TileCounters& total, const TileCounters& part) {
  total.rays += part.rays;
  total.rays_reached += part.rays_reached;
  total.pairs += part.pairs;
  total.pairs_left_to_chance += part.pairs_left_to_chance;
  total.pairs_skipped += part.pairs_skipped;
  total.pixels_skipped += part.pixels_skipped;
  total.tiles_skipped += part.tiles_skipped;
  total.table.looked_up += part.table.looked_up;
  total.table.corrected += part.table.corrected;
  total.table.rough += part.table.rough;
  total.table.nodes += part.table.nodes;
  total.table.clamped += part.table.clamped;
  total.table.clamped_sum += part.table.clamped_sum;
  total.table.total += part.table.total;
  total.seconds_generate += part.seconds_generate;
  total.seconds_optics += part.seconds_optics;
  total.seconds_medium += part.seconds_medium;
  total.seconds_surfaces += part.seconds_surfaces;
  total.medium += part.medium;
}

/// What one thread traces with: the tracer of a range, until jobs of another one come.
template <class Real>
class Tracer {
 public:
  explicit Tracer(const std::vector<std::unique_ptr<const BackwardPlan<Real>>>& plans)
      : plans_(plans) {}

  TileTracer<Real>& of(std::size_t range, Film& film) {
    if (!current_ || range != range_) {
      if (current_) add(counters_, current_->counters());
      current_ = std::make_unique<TileTracer<Real>>(*plans_[range], film);
      range_ = range;
    }
    return *current_;
  }
  void add_to(TileCounters& total) const {
    add(total, counters_);
    if (current_) add(total, current_->counters());
  }

 private:
  const std::vector<std::unique_ptr<const BackwardPlan<Real>>>& plans_;
  std::unique_ptr<TileTracer<Real>> current_;
  std::size_t range_ = 0;
  TileCounters counters_;  ///< of those before
};

template <class Real>
bool run_plans(const std::vector<std::unique_ptr<const BackwardPlan<Real>>>& plans,
               const std::vector<PointRange>& ranges, const std::vector<TileJob>& jobs,
               const Execution& execution, Film& film, RenderStatistics& statistics) {
  const int workers = execution.thread_count();
  const std::size_t parts = plans.size() / std::max<std::size_t>(ranges.size(), 1);
  std::vector<Tracer<Real>> tracers;
  for (int i = 0; i < workers; ++i) tracers.emplace_back(plans);
  std::vector<std::vector<double>> memory(static_cast<std::size_t>(workers));  // of tiles' sums
  const auto start = std::chrono::steady_clock::now();
  std::mutex mutex;
  std::size_t done = 0;
  const double rays_before = statistics.rays;
  const bool complete = parallel_for(execution, jobs.size(), [&](std::size_t index, int worker) {
    const TileJob job = jobs[index];
    double new_rays = 0;
    if (film.allows_finishing())
      film.lend(job.tile, std::move(memory[static_cast<std::size_t>(worker)]));
    for (std::size_t part = 0; part < parts; ++part) {
      TileTracer<Real>& tracer =
          tracers[static_cast<std::size_t>(worker)].of(job.range * parts + part, film);
      new_rays -= tracer.counters().rays;
      tracer.render(job.tile);
      new_rays += tracer.counters().rays;
    }
    film.add_samples(job.tile, ranges[job.range].points);
    if (film.allows_finishing()) memory[static_cast<std::size_t>(worker)] = film.finish(job.tile);
    const std::lock_guard lock(mutex);
    ++done;
    if (!execution.progress) return;
    statistics.rays += new_rays;
    Progress progress;
    progress.fraction = static_cast<double>(done) / static_cast<double>(jobs.size());
    const double elapsed = seconds_since(start);
    progress.rays = statistics.rays;
    progress.rays_per_second = (statistics.rays - rays_before) / elapsed;
    progress.relative_error = statistics.relative_error;
    progress.remaining_seconds = elapsed * (1 / progress.fraction - 1);
    execution.progress(progress);
  });
  statistics.rays = rays_before;
  TileCounters total;
  for (const auto& tracer : tracers) tracer.add_to(total);
  statistics.rays += total.rays;
  statistics.rays_reached += total.rays_reached;
  statistics.pairs += total.pairs;
  statistics.pairs_left_to_chance += total.pairs_left_to_chance;
  statistics.pairs_skipped += total.pairs_skipped;
  statistics.pixels_skipped += total.pixels_skipped;
  statistics.tiles += static_cast<double>(done);
  statistics.tiles_skipped += total.tiles_skipped;
  statistics.table_looked_up += total.table.looked_up;
  statistics.table_corrected += total.table.corrected;
  statistics.table_rough += total.table.rough;
  statistics.table_nodes += total.table.nodes;
  statistics.table_clamped += total.table.clamped;
  statistics.table_clamped_sum += total.table.clamped_sum;
  statistics.table_sum += total.table.total;
  statistics.seconds_optics += total.seconds_optics;
  statistics.seconds_medium += total.seconds_medium;
  statistics.seconds_surfaces += total.seconds_surfaces;
  const double busy = seconds_since(start) * workers;
  statistics.seconds_generate +=
      std::max(0.0, busy - total.seconds_optics - total.seconds_medium - total.seconds_surfaces);
  statistics.medium += total.medium;
  return complete;
}

}  // namespace

template <class Real>
BackwardKernels<Real> backward_kernels(Isa isa) {
  PLENOFLAME_DISPATCH(isa, return {kernels::generate, kernels::multiply, kernels::add_neighbours,
                                   kernels::sum, kernels::survey_rows, kernels::judge_rows};)
}
template BackwardKernels<float> backward_kernels<float>(Isa);
template BackwardKernels<double> backward_kernels<double>(Isa);

template <class Real>
BackwardPlan<Real> make_pass_plan(const CompiledScene& scene, const Medium& medium,
                                  const RenderSettings& settings, const PointRange& range,
                                  const SurfaceLightPlan* light, const ScatterPlan* scatter) {
  return make_plan<Real>(scene, medium, settings, range, make_pools(settings, range), light,
                         scatter);
}
template BackwardPlan<float> make_pass_plan<float>(const CompiledScene&, const Medium&,
                                                   const RenderSettings&, const PointRange&,
                                                   const SurfaceLightPlan*, const ScatterPlan*);
template BackwardPlan<double> make_pass_plan<double>(const CompiledScene&, const Medium&,
                                                     const RenderSettings&, const PointRange&,
                                                     const SurfaceLightPlan*, const ScatterPlan*);

void count_lenses(const CompiledScene& scene, const BackwardShared& shared,
                  const PixelWindow& window, RenderStatistics& statistics) {
  const Camera& camera = scene.camera;
  if (!camera.has_array()) return;
  const double reach = micro_image_reach(scene.pupils);
  const Vec2 margin{reach, reach};
  const Vec2 a = camera.sensor_point(window.x + window.width, window.y + window.height);
  const Vec2 b = camera.sensor_point(window.x, window.y);
  for (const LensIndex lens : camera.lattice().within(a - margin, b + margin)) {
    statistics.lenses += 1;
    if (shared.beams &&
        !shared.beams->lenses().may_meet(camera.lattice().type(lens), camera.lens_place(lens)))
      statistics.lenses_skipped += 1;
  }
}

bool single_precision_suffices(const CompiledScene& scene) {
  const auto fine = [&](const Box& box, double feature_size) {
    if (box.empty()) return true;
    const double distance = length(0.5 * (box.lower + box.upper) - scene.camera.spec().position);
    // Directions carry a few units of 6e-8: a ray wanders by 3e-7 of the distance.
    return 3e-7 * distance < 0.02 * feature_size;
  };
  return (!scene.medium || fine(scene.medium->bounds(), scene.medium->feature_size())) &&
         (!scene.surfaces || fine(scene.surfaces->bounds(), scene.surfaces->feature_size()));
}

namespace {

bool in_single_precision(const CompiledScene& scene, const RenderSettings& settings) {
  return settings.precision == Precision::single_precision ||
         (settings.precision == Precision::automatic && single_precision_suffices(scene));
}

/// The table of radiance for a scene; nullptr where the settings refuse it or it would not pay.
std::unique_ptr<RadianceTable> make_radiance_table(const CompiledScene& scene,
                                                   const RenderSettings& settings) {
  if (!settings.control_variate || !in_single_precision(scene, settings)) return nullptr;
  // The table knows whole lines, which surfaces cut.
  if (!scene.medium || scene.surfaces || !scene.lights.environment.empty()) return nullptr;
  if (!scene.scatterers.empty()) return nullptr;  // walks take far longer than it could save
  const Box box = scene.medium->bounds();
  MediumOptions options;
  options.isa = settings.isa;
  options.skip = settings.skip;
  const Vec3 anchor = 0.5 * (box.lower + box.upper);
  if (scene.mix.empty()) return RadianceTable::make(scene.camera, *scene.medium, anchor, options);
  // It holds channels, whatever stands for them.
  auto sum = std::make_unique<ChannelSum>(*scene.medium, scene.mix);
  std::unique_ptr<RadianceTable> table = RadianceTable::make(scene.camera, *sum, anchor, options);
  if (table) table->keep(std::move(sum));
  return table;
}

}  // namespace

BackwardShared::BackwardShared(const CompiledScene& scene, const RenderSettings& settings,
                               const Execution& execution)
    : beams(settings.skip && has_content(scene) ? SceneBeams::make(scene) : nullptr),
      table(scene.parts.empty() ? make_radiance_table(scene, settings) : nullptr),
      light(scene.parts.empty() ? make_surface_light(scene, settings, execution) : nullptr),
      scatter(scene.parts.empty() ? make_scatter_plan(scene, settings, execution, light.get())
                                  : nullptr) {
  for (const CompiledScene& part : scene.parts) parts.emplace_back(part, settings, execution);
}

template <class Real>
void BackwardPass::make_plans(const CompiledScene& scene, const RenderSettings& settings,
                              const BackwardShared& shared, int threads, Plans<Real>& plans) {
  plans.resize(ranges_.size() * media_.size());
  Execution execution;
  execution.threads = threads;
  // Wavelengths with ways of their own take the same numbers: caches hold them once.
  std::vector<std::shared_ptr<const SobolPools>> pools(ranges_.size());
  parallel_for(execution, pools.size(), [&](std::size_t r, int) {
    pools[r] = make_pools(settings, ranges_[r], pools.size() == 1 ? execution : alone());
  });
  parallel_for(execution, plans.size(), [&](std::size_t i, int) {
    const std::size_t range = i / media_.size(), p = i % media_.size();
    const CompiledScene& part = scene.parts.empty() ? scene : scene.parts[p];
    const BackwardShared& of_part = scene.parts.empty() ? shared : shared.parts[p];
    auto plan = std::make_unique<BackwardPlan<Real>>(
        make_plan<Real>(part, media_[p]->get(), settings, ranges_[range], pools[range],
                        of_part.light.get(), of_part.scatter.get()));
    if constexpr (std::is_same_v<Real, float>) plan->table = of_part.table.get();
    plan->beams = of_part.beams.get();
    plans[i] = std::move(plan);
  });
}

BackwardPass::BackwardPass(const CompiledScene& scene, const RenderSettings& settings,
                           std::vector<PointRange> ranges, const BackwardShared& shared,
                           int threads)
    : ranges_(std::move(ranges)), is_single_(in_single_precision(scene, settings)) {
  if (scene.parts.empty()) media_.push_back(std::make_unique<SceneMedium>(scene));
  for (const CompiledScene& part : scene.parts)
    media_.push_back(std::make_unique<SceneMedium>(part));
  if (is_single_)
    make_plans(scene, settings, shared, threads, single_);
  else
    make_plans(scene, settings, shared, threads, double_);
}

BackwardPass::~BackwardPass() = default;

bool BackwardPass::run(const std::vector<TileJob>& jobs, const Execution& execution, Film& film,
                       RenderStatistics& statistics) const {
  std::vector<bool> seen(static_cast<std::size_t>(film.tile_count()));
  for (const TileJob& job : jobs) {
    // Two threads would add to the same sums.
    if (seen[static_cast<std::size_t>(job.tile)])
      throw std::logic_error("a tile comes twice in a pass");
    seen[static_cast<std::size_t>(job.tile)] = true;
  }
  statistics.precision = is_single_ ? "single" : "double";
  return is_single_ ? run_plans(single_, ranges_, jobs, execution, film, statistics)
                    : run_plans(double_, ranges_, jobs, execution, film, statistics);
}

}  // namespace plenoflame
