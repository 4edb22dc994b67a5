#include "render/tracer/window_integrator.h"

#include <algorithm>
#include <chrono>

#include "render/run/run_control.h"

namespace plenoflame {
namespace {

/// The same as for rays without windows, separately for each stretch.

MediumOptions options_of(const RenderSettings& settings) {
  MediumOptions options;
  options.isa = settings.isa;
  options.skip = settings.skip;
  return options;
}

}  // namespace

template <class Real>
Ray ray_from_front(const KernelBlock<Real>& block, int i, Vec3 anchor, const CameraFront& front) {
  const Ray line{anchor + Vec3{static_cast<double>(block.x[i]), static_cast<double>(block.y[i]),
                               static_cast<double>(block.z[i])},
                 normalize({static_cast<double>(block.dx[i]), static_cast<double>(block.dy[i]),
                            static_cast<double>(block.dz[i])})};
  return {line.at(front.t_near(line)), line.direction};
}

template <class Real>
void trace_ways(const TracedRays<Real>& rays, const WindowSet& windows, Vec3 anchor,
                const CameraFront& front, WindowPath& scratch, WindowWays& ways) {
  ways.clear(static_cast<std::size_t>(rays.count));
  for (int i = 0; i < rays.count; ++i)
    if (rays.block.weight[i] > 0 && rays.block.code[i] == 0)
      ways.add(static_cast<std::size_t>(i), windows, ray_from_front(rays.block, i, anchor, front),
               scratch);
}

template <class Real>
WindowIntegrator<Real>::WindowIntegrator(const BackwardPlan<Real>& plan,
                                         SurfaceBlock<Real>* surfaces, ScatterWalk* scatter)
    : plan_(plan),
      front_(plan.scene->camera),
      surfaces_(surfaces),
      scatter_(scatter),
      nodes_(static_cast<std::size_t>(plan.scene->node_count())),
      segments_(plan.medium, options_of(*plan.settings)),
      passed_(nodes_) {}

template <class Real>
void WindowIntegrator<Real>::integrate(const TracedRays<Real>& rays, Real* radiance, int stride,
                                       Real* transmittance, MediumCounters& counters) {
  const auto start = std::chrono::steady_clock::now();
  trace_ways(rays, *plan_.scene->windows, plan_.anchor, front_, path_, ways_);
  if (surfaces_) surfaces_->trace_ways(ways_, rays.groups, counters);
  seconds_surfaces_ += seconds_since(start);
  segments_.clear();
  for (const AirSegment& segment : ways_.segments) segments_.add(segment.ray, segment.far);
  segments_.integrate(true, counters);
  if (scatter_) add_scattered(rays, counters);
  const std::size_t stretches = ways_.segments.size();
  shares_.assign(nodes_ * stretches, Real(0));
  for (std::size_t c = 0; c < nodes_; ++c)
    std::fill_n(radiance + c * static_cast<std::size_t>(stride), rays.padded, Real(0));
  std::fill_n(transmittance, rays.padded, Real(1));
  for (int i = 0; i < rays.count; ++i) {
    const WindowWays::Way& way = ways_.ways[static_cast<std::size_t>(i)];
    std::fill(passed_.begin(), passed_.end(), 1.0);
    for (std::size_t s = way.first; s < way.first + way.count; ++s) {
      const double through = ways_.segments[s].throughput;
      for (std::size_t c = 0; c < nodes_; ++c) {
        double light = segments_.radiance(s, static_cast<int>(c));
        if (scatter_) light += scattered_[c][s];
        light *= passed_[c];
        passed_[c] *= segments_.transmittance(s, c);
        if (surfaces_ && s + 1 == way.first + way.count)
          light += passed_[c] * surfaces_->radiance(i, c);
        const Real share = static_cast<Real>(through * light);
        shares_[c * stretches + s] = share;
        radiance[c * static_cast<std::size_t>(stride) + static_cast<std::size_t>(i)] += share;
      }
    }
    transmittance[i] = static_cast<Real>(passed_[0]);
  }
}

/// Adds the light that the medium scatters into each stretch, with one walk for each stretch.
template <class Real>
void WindowIntegrator<Real>::add_scattered(const TracedRays<Real>& rays, MediumCounters& counters) {
  scattered_.assign(nodes_, std::vector<double>(ways_.segments.size()));
  std::vector<ScatterWalk::Start> starts;
  for (const RayGroup& group : rays.groups) {
    const int points = plan_.pools()[static_cast<std::size_t>(group.level)].points();
    for (int i = group.first; i < group.first + group.count; ++i) {
      const WindowWays::Way& way = ways_.ways[static_cast<std::size_t>(i)];
      const int number = group.offset + i - group.first;
      const auto replicate = static_cast<std::uint64_t>(number / points);
      const auto point =
          (plan_.points.first >> group.level) + static_cast<std::uint32_t>(number % points);
      const std::uint64_t key =
          mix64(mix64(group.key + kScatterSeed + static_cast<std::uint64_t>(group.level)) ^
                (replicate << 32 | point));
      for (std::size_t k = 0; k < way.count; ++k) {
        const std::size_t s = way.first + k;
        const double through = std::clamp(segments_.transmittance(s), 0.0, 1.0);
        starts.push_back({static_cast<int>(s), ways_.segments[s].ray, mix64(key + k),
                          ways_.segments[s].far, through * through});
      }
    }
  }
  scatter_->add(starts, scattered_, counters);
}

template Ray ray_from_front<float>(const KernelBlock<float>&, int, Vec3, const CameraFront&);
template Ray ray_from_front<double>(const KernelBlock<double>&, int, Vec3, const CameraFront&);
template void trace_ways<float>(const TracedRays<float>&, const WindowSet&, Vec3,
                                const CameraFront&, WindowPath&, WindowWays&);
template void trace_ways<double>(const TracedRays<double>&, const WindowSet&, Vec3,
                                 const CameraFront&, WindowPath&, WindowWays&);
template class WindowIntegrator<float>;
template class WindowIntegrator<double>;

}  // namespace plenoflame
