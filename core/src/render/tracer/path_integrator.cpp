#include "render/tracer/path_integrator.h"

#include <algorithm>
#include <chrono>

#include "render/run/run_control.h"

namespace plenoflame {
namespace {

MediumOptions options_of(const RenderSettings& settings) {
  MediumOptions options;
  options.isa = settings.isa;
  options.skip = settings.skip;
  return options;
}

}  // namespace

template <class Real>
Ray line_of(const KernelBlock<Real>& block, int i, Vec3 anchor) {
  return {anchor + Vec3{static_cast<double>(block.x[i]), static_cast<double>(block.y[i]),
                        static_cast<double>(block.z[i])},
          normalize({static_cast<double>(block.dx[i]), static_cast<double>(block.dy[i]),
                     static_cast<double>(block.dz[i])})};
}

template <class Real>
void trace_paths(const TracedRays<Real>& rays, Vec3 anchor, WorldPaths& paths) {
  paths.clear(static_cast<std::size_t>(rays.count));
  for (int i = 0; i < rays.count; ++i)
    if (rays.block.weight[i] > 0 && rays.block.code[i] == 0)
      paths.add(static_cast<std::size_t>(i), line_of(rays.block, i, anchor));
}

template <class Real>
PathIntegrator<Real>::PathIntegrator(const BackwardPlan<Real>& plan)
    : plan_(plan),
      nodes_(static_cast<std::size_t>(plan.scene->node_count())),
      segments_(plan.medium, options_of(*plan.settings)),
      paths_(*plan.scene),
      passed_(nodes_) {
  if (plan.scatter) scatter_ = std::make_unique<ScatterWalk>(*plan.scatter);
  if (plan.surfaces)
    surfaces_ = std::make_unique<SurfaceBlock>(*plan.surfaces, nodes_, scatter_.get());
}

template <class Real>
void PathIntegrator<Real>::integrate(const TracedRays<Real>& rays, Real* radiance, int stride,
                                     Real* transmittance, MediumCounters& counters) {
  const auto start = std::chrono::steady_clock::now();
  trace_paths(rays, plan_.anchor, paths_);
  if (surfaces_) surfaces_->follow(paths_, rays.groups, counters);
  seconds_surfaces_ += seconds_since(start);
  const std::span<const AirSegment> stretches = paths_.stretches();
  segments_.clear();
  for (const AirSegment& stretch : stretches) segments_.add(stretch.ray, stretch.far);
  segments_.integrate(true, counters);
  if (scatter_) add_scattered(rays, counters);
  shares_.assign(nodes_ * stretches.size(), Real(0));
  for (std::size_t c = 0; c < nodes_; ++c)
    std::fill_n(radiance + c * static_cast<std::size_t>(stride), rays.padded, Real(0));
  std::fill_n(transmittance, rays.padded, Real(1));
  for (int i = 0; i < rays.count; ++i) {
    const WorldPath& path = paths_[static_cast<std::size_t>(i)];
    std::fill(passed_.begin(), passed_.end(), 1.0);
    for (std::size_t s = path.first; s < path.first + path.count; ++s) {
      const double through = stretches[s].throughput;
      for (std::size_t c = 0; c < nodes_; ++c) {
        double light = segments_.radiance(s, static_cast<int>(c));
        if (scatter_) light += scattered_[c][s];
        light *= passed_[c];
        passed_[c] *= segments_.transmittance(s, c);
        if (surfaces_ && s + 1 == path.first + path.count)
          light += passed_[c] * surfaces_->radiance(i, c);
        const Real share = static_cast<Real>(through * light);
        shares_[c * stretches.size() + s] = share;
        radiance[c * static_cast<std::size_t>(stride) + static_cast<std::size_t>(i)] += share;
      }
    }
    transmittance[i] = static_cast<Real>(passed_[0]);
  }
}

/// Adds the light that the medium scatters into each stretch, with one walk for each stretch.
template <class Real>
void PathIntegrator<Real>::add_scattered(const TracedRays<Real>& rays, MediumCounters& counters) {
  scattered_.assign(nodes_, std::vector<double>(paths_.stretches().size()));
  std::vector<ScatterWalk::Start> starts;
  for (const RayGroup& group : rays.groups) {
    const int points = plan_.pools()[static_cast<std::size_t>(group.level)].points();
    for (int i = group.first; i < group.first + group.count; ++i) {
      const WorldPath& path = paths_[static_cast<std::size_t>(i)];
      const int number = group.offset + i - group.first;
      const auto replicate = static_cast<std::uint64_t>(number / points);
      const auto point =
          (plan_.points.first >> group.level) + static_cast<std::uint32_t>(number % points);
      const std::uint64_t key =
          mix64(mix64(group.key + kScatterSeed + static_cast<std::uint64_t>(group.level)) ^
                (replicate << 32 | point));
      for (std::size_t s = path.first; s < path.first + path.count; ++s) {
        // The share is almost 1 in a thin medium, and small if most rays are scattered anyway.
        double even = 0;
        const std::size_t passes = segments_.is_grey() ? 1 : nodes_;
        for (std::size_t c = 0; c < passes; ++c) {
          const double through = std::clamp(segments_.transmittance(s, c), 0.0, 1.0);
          even += through * through / static_cast<double>(passes);
        }
        const AirSegment& stretch = paths_.stretches()[s];
        const std::uint64_t own_key = s == path.first ? key : mix64(key + (s - path.first));
        starts.push_back({static_cast<int>(s), stretch.ray, own_key, stretch.far, even, 0});
      }
    }
  }
  scatter_->add(starts, scattered_, counters);
}

template Ray line_of<float>(const KernelBlock<float>&, int, Vec3);
template Ray line_of<double>(const KernelBlock<double>&, int, Vec3);
template void trace_paths<float>(const TracedRays<float>&, Vec3, WorldPaths&);
template void trace_paths<double>(const TracedRays<double>&, Vec3, WorldPaths&);
template class PathIntegrator<float>;
template class PathIntegrator<double>;

}  // namespace plenoflame
