#include "render/tracer/radiance_integrator.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include "render/run/run_control.h"
#include "render/transport/channel_sum.h"

namespace plenoflame {
namespace {

constexpr int kLeastTablePoints = 8;  ///< of a replicate; with fewer, every ray is integrated
/// One of this number of points corrects the table, in smooth and in fair places.
constexpr int kSmoothPoints = 16, kFairPoints = 4;

/// Columns of transmittance: light from behind a medium needs that of every node.
template <class Real>
std::size_t transmittances(const BackwardPlan<Real>& plan) {
  return plan.surfaces && !plan.medium->is_grey()
             ? static_cast<std::size_t>(plan.scene->node_count())
             : 1;
}

}  // namespace

template <class Real>
RadianceIntegrator<Real>::RadianceIntegrator(const BackwardPlan<Real>& plan)
    : plan_(plan),
      columns_(1 + transmittances(plan) + static_cast<std::size_t>(plan.scene->node_count())) {
  fair_factor_ = columns_[0];
  transmittance_ = columns_[1];
  radiance_ = columns_[1 + transmittances(plan)];
  if (transmittances(plan) > 1) transmittance_stride_ = kPaddedBlock;
  if (plan.scatter) scatter_ = std::make_unique<ScatterWalk>(*plan.scatter);
  if (plan.surfaces)
    surfaces_ = std::make_unique<SurfaceBlock<Real>>(*plan.surfaces, plan.scene->node_count(),
                                                     scatter_.get());
  if (plan.scene->windows && !plan.medium_bends)
    windows_ = std::make_unique<WindowIntegrator<Real>>(plan, surfaces_.get(), scatter_.get());
}

template <class Real>
void RadianceIntegrator<Real>::integrate(const TracedRays<Real>& rays) {
  auto last = std::chrono::steady_clock::now();
  // Time since the last call. A clock takes long in comparison with a block of rays.
  const auto lap = [&last] {
    const auto before = std::exchange(last, std::chrono::steady_clock::now());
    return std::chrono::duration<double>(last - before).count();
  };
  if (windows_) {
    windows_->integrate(rays, radiance_, kPaddedBlock, transmittance_, counters_.medium);
    mix_nodes(rays);
    const double before = std::exchange(counters_.stages.surfaces, windows_->seconds_surfaces());
    counters_.stages.medium += lap() - (counters_.stages.surfaces - before);
    return;
  }
  if (surfaces_) {
    surfaces_->trace(rays.block, rays.groups, rays.padded, counters_.medium);
    counters_.stages.surfaces += lap();
  }
  if (!integrate_by_table(rays)) integrate_rays(rays);
  counters_.stages.medium += lap();
}

template <class Real>
void RadianceIntegrator<Real>::integrate_rays(const TracedRays<Real>& rays) {
  RayBatch<Real> batch;
  batch.size = rays.padded;
  batch.anchor = plan_.anchor;
  batch.x = rays.block.x;
  batch.y = rays.block.y;
  batch.z = rays.block.z;
  batch.dx = rays.block.dx;
  batch.dy = rays.block.dy;
  batch.dz = rays.block.dz;
  MediumOptions options;
  options.isa = plan_.settings->isa;
  options.skip = plan_.settings->skip;
  RadianceBatch<Real> out;
  out.radiance = radiance_;
  out.stride = kPaddedBlock;
  out.transmittance = transmittance_;
  out.transmittance_stride = transmittance_stride_;
  if (surfaces_) batch.t_far = surfaces_->t_far();
  plan_.medium->integrate(batch, options, out, counters_.medium);
  if (surfaces_) surfaces_->add(transmittance_, transmittance_stride_, radiance_, kPaddedBlock);
  if (scatter_) add_scattered(rays);
  mix_nodes(rays);
}

/// Sums the nodes to channels.
template <class Real>
void RadianceIntegrator<Real>::mix_nodes(const TracedRays<Real>& rays) {
  if (plan_.scene->part_mixes.empty())
    sum_channels(plan_.scene->mix, radiance_, kPaddedBlock, rays.padded);
  else
    filter(rays);
}

/// Attenuates the light by the filters over parts of the stop, according to where each ray crosses
/// the stop.
template <class Real>
void RadianceIntegrator<Real>::filter(const TracedRays<Real>& rays) {
  const PupilFilters& filters = plan_.scene->camera.pupil_filters();
  pupil_parts_.resize(static_cast<std::size_t>(rays.padded));
  for (int i = 0; i < rays.padded; ++i)
    pupil_parts_[static_cast<std::size_t>(i)] = filters.part_at(
        {static_cast<double>(rays.block.stop_x[i]), static_cast<double>(rays.block.stop_y[i])});
  sum_channels_by_mix(plan_.scene->part_mixes, pupil_parts_.data(), radiance_, kPaddedBlock,
                      rays.padded);
}

/// Adds the light that the medium scatters into the rays, with one walk for each ray.
template <class Real>
void RadianceIntegrator<Real>::add_scattered(const TracedRays<Real>& rays) {
  std::vector<ScatterWalk::Start> starts;
  std::vector<std::vector<double>> scattered(
      static_cast<std::size_t>(plan_.scene->node_count()),
      std::vector<double>(static_cast<std::size_t>(rays.count)));
  for (const RayGroup& group : rays.groups) {
    const int points = plan_.pools()[static_cast<std::size_t>(group.level)].points();
    for (int i = group.first; i < group.first + group.count; ++i) {
      if (rays.block.code[i] != 0 || !(rays.block.weight[i] > 0)) continue;
      const int number = group.offset + i - group.first;
      const auto replicate = static_cast<std::uint64_t>(number / points);
      const auto point =
          (plan_.points.first >> group.level) + static_cast<std::uint32_t>(number % points);
      const Vec3 along{static_cast<double>(rays.block.dx[i]), static_cast<double>(rays.block.dy[i]),
                       static_cast<double>(rays.block.dz[i])};
      // The share is almost 1 in a thin medium, and small if most rays are scattered anyway.
      double even = 0;
      const std::size_t nodes = transmittance_stride_ ? scattered.size() : 1;
      for (std::size_t c = 0; c < nodes; ++c) {
        const Real passes = transmittance_[c * static_cast<std::size_t>(transmittance_stride_) +
                                           static_cast<std::size_t>(i)];
        const double through = std::clamp(static_cast<double>(passes), 0.0, 1.0);
        even += through * through / static_cast<double>(nodes);
      }
      starts.push_back(
          {i,
           {plan_.anchor + Vec3{static_cast<double>(rays.block.x[i]),
                                static_cast<double>(rays.block.y[i]),
                                static_cast<double>(rays.block.z[i])},
            normalize(along)},
           mix64(mix64(group.key + kScatterSeed + static_cast<std::uint64_t>(group.level)) ^
                 (replicate << 32 | point)),
           surfaces_ ? surfaces_->end(i) : std::numeric_limits<double>::infinity(),
           even});
    }
  }
  scatter_->add(starts, scattered, counters_.medium);
  for (std::size_t c = 0; c < scattered.size(); ++c)
    for (std::size_t i = 0; i < scattered[c].size(); ++i)
      radiance_[c * static_cast<std::size_t>(kPaddedBlock) + i] +=
          static_cast<Real>(scattered[c][i]);
}

/// Corrects the table with the first points of each replicate in a pixel, which are well spread by
/// themselves.
/// @return false without a table, or with too few points for it
template <class Real>
bool RadianceIntegrator<Real>::integrate_by_table([[maybe_unused]] const TracedRays<Real>& rays) {
  if constexpr (std::is_same_v<Real, float>) {
    if (!plan_.table || plan_.pools().front().points() < kLeastTablePoints) return false;
    if (!table_worker_) table_worker_ = std::make_unique<RadianceTable::Worker>(*plan_.table);
    const auto set = [&](float* factors, int per_correction) {
      std::fill_n(factors, rays.padded, 0.F);
      for (const PixelRays& pixel : rays.pixels) {
        const int points = pixel.points;
        const int corrected =
            points < kLeastTablePoints ? points : (points + per_correction - 1) / per_correction;
        const float factor = static_cast<float>(points) / static_cast<float>(corrected);
        for (int i = 0; i < pixel.count; ++i)
          if ((pixel.offset + i) % points < corrected) factors[pixel.first + i] = factor;
      }
    };
    set(transmittance_, kSmoothPoints);  // nothing else needs this array here
    set(fair_factor_, kFairPoints);
    table_worker_->integrate(
        {&rays.block, rays.padded, transmittance_, fair_factor_, radiance_, kPaddedBlock},
        counters_.medium);
    counters_.table = table_worker_->counters();
    return true;
  } else {
    return false;
  }
}

template class RadianceIntegrator<float>;
template class RadianceIntegrator<double>;

}  // namespace plenoflame
