#include "render/tracer/path_integrator.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

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
  const Vec3 along{static_cast<double>(block.dx[i]), static_cast<double>(block.dy[i]),
                   static_cast<double>(block.dz[i])};
  // Directions have almost length 1: there is no need for the care of length().
  return {anchor + Vec3{static_cast<double>(block.x[i]), static_cast<double>(block.y[i]),
                        static_cast<double>(block.z[i])},
          (1 / std::sqrt(dot(along, along))) * along};
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
      passes_(plan.medium->is_grey() ? 1 : nodes_),
      columns_(1 + passes_),
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
  const RadianceBatch<Real> out{radiance, stride, transmittance};
  if (paths_.may_bend())
    integrate_stretches(rays, out, counters);
  else
    integrate_lines(rays, out, counters);
}

/// The medium takes the block's own lines, up to their ends.
template <class Real>
void PathIntegrator<Real>::integrate_lines(const TracedRays<Real>& rays,
                                           const RadianceBatch<Real>& out,
                                           MediumCounters& counters) {
  const KernelBlock<Real>& block = rays.block;
  Real* const far = columns_[0];
  std::fill_n(far, rays.padded, std::numeric_limits<Real>::infinity());
  for (int i = 0; i < rays.count; ++i) {
    const WorldPath& path = paths_[static_cast<std::size_t>(i)];
    if (path.hit < 0) continue;
    const Vec3 along{static_cast<double>(block.dx[i]), static_cast<double>(block.dy[i]),
                     static_cast<double>(block.dz[i])};
    const Vec3 from{static_cast<double>(block.x[i]), static_cast<double>(block.y[i]),
                    static_cast<double>(block.z[i])};
    far[i] = static_cast<Real>(dot(paths_.hit(path).point - plan_.anchor - from, along) /
                               dot(along, along));
  }
  std::fill(far + rays.count, far + rays.padded, far[0]);
  RayBatch<Real> batch;
  batch.size = rays.padded;
  batch.anchor = plan_.anchor;
  batch.x = block.x, batch.y = block.y, batch.z = block.z;
  batch.dx = block.dx, batch.dy = block.dy, batch.dz = block.dz;
  batch.t_far = far;
  RadianceBatch<Real> whole = out;
  whole.transmittance = columns_[1];
  whole.transmittance_stride = passes_ > 1 ? kPaddedBlock : 0;
  plan_.medium->integrate(batch, options_of(*plan_.settings), whole, counters);
  const auto passed_at = [&](std::size_t c) { return columns_[passes_ > 1 ? 1 + c : 1]; };
  if (scatter_)
    add_scattered(
        rays,
        [&](int i, std::size_t, std::size_t c) { return static_cast<double>(passed_at(c)[i]); },
        counters);
  for (std::size_t c = 0; c < nodes_; ++c) {
    Real* const radiance = out.radiance + c * static_cast<std::size_t>(out.stride);
    const Real* const passed = passed_at(c);
    for (int i = 0; i < rays.count && surfaces_; ++i)
      radiance[i] += passed[i] * static_cast<Real>(surfaces_->radiance(i, c));
    for (int i = 0; i < rays.count && scatter_; ++i)
      if (const WorldPath& path = paths_[static_cast<std::size_t>(i)]; path.count > 0)
        radiance[i] += static_cast<Real>(scattered_[c][path.first]);
  }
  std::copy_n(columns_[1], rays.padded, out.transmittance);
}

template <class Real>
void PathIntegrator<Real>::integrate_stretches(const TracedRays<Real>& rays,
                                               const RadianceBatch<Real>& out,
                                               MediumCounters& counters) {
  const std::span<const AirSegment> stretches = paths_.stretches();
  segments_.clear();
  for (const AirSegment& stretch : stretches) segments_.add(stretch.ray, stretch.far);
  segments_.integrate(true, counters);
  if (scatter_)
    add_scattered(
        rays, [&](int, std::size_t s, std::size_t c) { return segments_.transmittance(s, c); },
        counters);
  shares_.assign(nodes_ * stretches.size(), Real(0));
  for (std::size_t c = 0; c < nodes_; ++c)
    std::fill_n(out.radiance + c * static_cast<std::size_t>(out.stride), rays.padded, Real(0));
  std::fill_n(out.transmittance, rays.padded, Real(1));
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
        out.radiance[c * static_cast<std::size_t>(out.stride) + static_cast<std::size_t>(i)] +=
            share;
      }
    }
    out.transmittance[i] = static_cast<Real>(passed_[0]);
  }
}

/// Finds the light that the medium scatters into each stretch, with one walk for each stretch.
/// @param passed gives the transmittance of a ray, stretch and node
template <class Real>
template <class Passed>
void PathIntegrator<Real>::add_scattered(const TracedRays<Real>& rays, const Passed& passed,
                                         MediumCounters& counters) {
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
        for (std::size_t c = 0; c < passes_; ++c) {
          const double through = std::clamp(passed(i, s, c), 0.0, 1.0);
          even += through * through / static_cast<double>(passes_);
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
