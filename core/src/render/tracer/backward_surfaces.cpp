#include "render/tracer/backward_surfaces.h"

#include <algorithm>

namespace plenoflame {
namespace {

/// Seeds that differ from those of the camera's rays, and from each other.
constexpr std::uint64_t kLightSeed = 0x6c69676874u, kFirstLightSeed = 0x6669727374u;

}  // namespace

BackwardSurfacePlan::BackwardSurfacePlan(const SurfaceLightPlan& surface_light,
                                         const RenderSettings& settings, std::uint32_t first_point,
                                         const std::vector<SobolPool>& camera_pools)
    : light(surface_light), first(first_point) {
  if (!light.random()) return;
  for (std::size_t level = 0; level < camera_pools.size(); ++level)
    pools.emplace_back(settings.replicates, camera_pools[level].points(), first >> level,
                       mix64(settings.seed + kLightSeed + level), SobolPool::kDimensions,
                       camera_pools[level].entries());
}

SurfaceBlock::SurfaceBlock(const BackwardSurfacePlan& plan, std::size_t channels, ScatterWalk* walk)
    : plan_(plan),
      light_(plan.light),
      walk_(walk),
      radiance_(channels, std::vector<double>(kBlockRays)) {}

SurfaceLight::First SurfaceBlock::random_of(const RayGroup& group, int point) const {
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

/// Follows the light from the end of ray i.
void SurfaceBlock::add_end(const SurfaceHit& hit, const RayGroup& group, int i) {
  SurfacePath& path = ends_.emplace_back();
  path.hit = hit;
  path.ray = i;
  const int points =
      plan_.pools.empty() ? 0 : plan_.pools[static_cast<std::size_t>(group.level)].points();
  if (points == 0) return;
  const int number = group.offset + i - group.first;
  random_.push_back(random_of(group, number));
  const auto replicate = static_cast<std::uint64_t>(number / points);
  const auto point = (plan_.first >> group.level) + static_cast<std::uint32_t>(number % points);
  // Each level counts its points separately.
  const auto level = static_cast<std::uint64_t>(group.level);
  path.key = mix64(mix64(group.key + kLightSeed + level) ^ (replicate << 32 | point));
}

void SurfaceBlock::follow(const WorldPaths& paths, const std::vector<RayGroup>& groups,
                          MediumCounters& counters) {
  for (std::vector<double>& channel : radiance_) std::fill(channel.begin(), channel.end(), 0.0);
  ends_.clear();
  random_.clear();
  const std::vector<double>& environment = plan_.light.scene->lights.environment;
  for (const RayGroup& group : groups)
    for (int i = group.first; i < group.first + group.count; ++i) {
      const WorldPath& path = paths[static_cast<std::size_t>(i)];
      if (path.hit >= 0)
        add_end(paths.hit(path), group, i);
      else if (path.open)
        for (std::size_t c = 0; c < environment.size(); ++c)
          radiance_[c][static_cast<std::size_t>(i)] = environment[c];
    }
  if (walk_)
    walk_->add_surfaces(ends_, random_, radiance_, counters);
  else
    light_.add(ends_, random_, radiance_, counters);
}

}  // namespace plenoflame
