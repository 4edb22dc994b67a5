#include "render/tracer/backward_surfaces.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace plenoflame {
namespace {

/// Seeds that differ from those of the camera's rays, and from each other.
constexpr std::uint64_t kLightSeed = 0x6c69676874u, kFirstLightSeed = 0x6669727374u;

}  // namespace

BackwardSurfacePlan::BackwardSurfacePlan(const SurfaceLightPlan& surface_light,
                                         const RenderSettings& settings, std::uint32_t first_point,
                                         const std::vector<SobolPool>& camera_pools,
                                         Vec3 anchor_point)
    : light(surface_light), first(first_point), anchor(anchor_point), front(light.scene->camera) {
  if (!light.random()) return;
  for (std::size_t level = 0; level < camera_pools.size(); ++level)
    pools.emplace_back(settings.replicates, camera_pools[level].points(), first >> level,
                       mix64(settings.seed + kLightSeed + level), SobolPool::kDimensions,
                       camera_pools[level].entries());
}

template <class Real>
SurfaceBlock<Real>::SurfaceBlock(const BackwardSurfacePlan& plan, int channels, ScatterWalk* walk)
    : plan_(plan),
      surfaces_(plan.light.scene->surfaces.get()),
      light_(plan.light),
      walk_(walk),
      ends_(kBlockRays, kInfinity) {
  constexpr std::size_t kAlignment = 64 / sizeof(Real);
  storage_.resize(kBlockRays + kBlockSlack + kAlignment);
  t_far_ = storage_.data();
  while (reinterpret_cast<std::uintptr_t>(t_far_) % 64 != 0) ++t_far_;
  radiance_.resize(static_cast<std::size_t>(channels), std::vector<double>(kBlockRays));
}

template <class Real>
SurfaceLight::First SurfaceBlock<Real>::random_of(const RayGroup& group, int point) const {
  SurfaceLight::First random{};
  const SobolPool& pool = plan_.pools[static_cast<std::size_t>(group.level)];
  // A shift for each replicate (SobolPool).
  const auto replicate = static_cast<std::uint64_t>(point / pool.points());
  const std::uint64_t h0 = mix64(group.key + kFirstLightSeed + (replicate << 32)), h1 = mix64(h0);
  const std::uint32_t shift[4] = {
      static_cast<std::uint32_t>(h0), static_cast<std::uint32_t>(h0 >> 32),
      static_cast<std::uint32_t>(h1), static_cast<std::uint32_t>(h1 >> 32)};
  const int entry = group.entry % pool.entries();
  for (int d = 0; d < 4; ++d)
    random.u[d] = ((pool.fractions(entry, d)[point] ^ shift[d]) + 0.5) * 0x1p-32;
  return random;
}

template <class Real>
void SurfaceBlock<Real>::trace_ray(const KernelBlock<Real>& block, const RayGroup& group, int i) {
  t_far_[i] = std::numeric_limits<Real>::infinity();
  ends_[static_cast<std::size_t>(i)] = kInfinity;
  if (!(block.weight[i] > 0)) return;
  const Vec3 along{static_cast<double>(block.dx[i]), static_cast<double>(block.dy[i]),
                   static_cast<double>(block.dz[i])};
  const double norm = length(along);
  const Ray ray{
      plan_.anchor + Vec3{static_cast<double>(block.x[i]), static_cast<double>(block.y[i]),
                          static_cast<double>(block.z[i])},
      (1 / norm) * along};
  SurfacePath path;
  if (surfaces_ && surfaces_->intersect(ray, plan_.front.t_near(ray), kInfinity, {}, path.hit)) {
    t_far_[i] = static_cast<Real>(path.hit.t / norm);
    ends_[static_cast<std::size_t>(i)] = path.hit.t;
    add_path(path, group, i);
    return;
  }
  add_surroundings(i);
}

template <class Real>
void SurfaceBlock<Real>::add_surroundings(int i) {
  const std::vector<double>& environment = plan_.light.scene->lights.environment;
  for (std::size_t c = 0; c < environment.size(); ++c)
    radiance_[c][static_cast<std::size_t>(i)] = environment[c];
}

/// Follows the light from the end of ray i. @param path knows this end
template <class Real>
void SurfaceBlock<Real>::add_path(SurfacePath path, const RayGroup& group, int i) {
  path.ray = i;
  const int points =
      plan_.pools.empty() ? 0 : plan_.pools[static_cast<std::size_t>(group.level)].points();
  if (points > 0) {
    const int number = group.offset + i - group.first;
    random_.push_back(random_of(group, number));
    const auto replicate = static_cast<std::uint64_t>(number / points);
    const auto point = (plan_.first >> group.level) + static_cast<std::uint32_t>(number % points);
    // Each level counts its points separately.
    const auto level = static_cast<std::uint64_t>(group.level);
    path.key = mix64(mix64(group.key + kLightSeed + level) ^ (replicate << 32 | point));
  }
  paths_.push_back(path);
}

template <class Real>
void SurfaceBlock<Real>::trace_ways(WindowWays& ways, const std::vector<RayGroup>& groups,
                                    MediumCounters& counters) {
  clear();
  for (const RayGroup& group : groups)
    for (int i = group.first; i < group.first + group.count; ++i) {
      WindowWays::Way& way = ways.ways[static_cast<std::size_t>(i)];
      SurfacePath path;
      if (const AirSegment* last =
              surfaces_ ? cut_at_surface(*surfaces_, ways, way, path.hit) : nullptr;
          last)
        add_path(path, group, i);
      else if (way.open)
        add_surroundings(i);
    }
  follow(counters);
}

template <class Real>
void SurfaceBlock<Real>::trace(const KernelBlock<Real>& block, const std::vector<RayGroup>& groups,
                               int padded, MediumCounters& counters) {
  clear();
  for (const RayGroup& group : groups) {
    for (int i = group.first; i < group.first + group.count; ++i) trace_ray(block, group, i);
    count_ = group.first + group.count;
  }
  for (int i = count_; i < padded; ++i) t_far_[i] = t_far_[0];
  follow(counters);
}

template <class Real>
void SurfaceBlock<Real>::clear() {
  for (std::vector<double>& channel : radiance_) std::fill(channel.begin(), channel.end(), 0.0);
  paths_.clear();
  random_.clear();
  count_ = 0;
}

template <class Real>
void SurfaceBlock<Real>::follow(MediumCounters& counters) {
  if (walk_)
    walk_->add_surfaces(paths_, random_, radiance_, counters);
  else
    light_.add(paths_, random_, radiance_, counters);
}

template <class Real>
void SurfaceBlock<Real>::add(const Real* transmittance, int transmittance_stride, Real* radiance,
                             int stride) const {
  for (std::size_t c = 0; c < radiance_.size(); ++c, transmittance += transmittance_stride) {
    Real* out = radiance + static_cast<std::ptrdiff_t>(c) * stride;
    for (int i = 0; i < count_; ++i)
      out[i] += transmittance[i] * static_cast<Real>(radiance_[c][static_cast<std::size_t>(i)]);
  }
}

template class SurfaceBlock<float>;
template class SurfaceBlock<double>;

}  // namespace plenoflame
