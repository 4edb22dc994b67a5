#include "render/tracer/radiance_integrator.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "plenoflame/sampling/sobol.h"
#include "render/run/run_control.h"
#include "render/transport/channel_sum.h"

namespace plenoflame {
namespace {

/// One of this number of rays corrects the table, in smooth and in fair places.
constexpr int kSmoothRays = 16, kFairRays = 4;

/// Which rays of a pixel correct the table, and how much each of them counts.
struct Corrections {
  int rays;      ///< of each replicate, the first ones, which are well spread by themselves
  float factor;  ///< of each
};
/// @param one_of rays that one stands for
Corrections corrections(int points, int one_of) {
  if (points < one_of) return {1, static_cast<float>(one_of)};  // where is_corrected()
  const int rays = (points + one_of - 1) / one_of;
  return {rays, static_cast<float>(points) / static_cast<float>(rays)};
}

/// Tells whether a replicate of fewer than `one_of` rays corrects the table. The chance is points /
/// one_of for each pixel, replicate and range.
bool is_corrected(const PixelRays& pixel, int replicate, std::uint32_t range, int one_of) {
  const std::uint64_t key = (std::uint64_t{range} << 32) + static_cast<std::uint64_t>(replicate);
  const std::uint64_t random = mix64(key ^ mix64(pixel.random)) >> 32;
  return random * static_cast<std::uint64_t>(one_of) >> 32 <
         static_cast<std::uint64_t>(pixel.points);
}

}  // namespace

template <class Real>
RadianceIntegrator<Real>::RadianceIntegrator(const BackwardPlan<Real>& plan)
    : plan_(plan), columns_(2 + static_cast<std::size_t>(plan.scene->node_count())) {
  fair_factor_ = columns_[0];
  transmittance_ = columns_[1];
  radiance_ = columns_[2];
  if (!plan.takes_lines) along_paths_ = std::make_unique<PathIntegrator<Real>>(plan);
}

template <class Real>
void RadianceIntegrator<Real>::integrate(const TracedRays<Real>& rays) {
  auto last = std::chrono::steady_clock::now();
  // Time since the last call. A clock takes long in comparison with a block of rays.
  const auto lap = [&last] {
    const auto before = std::exchange(last, std::chrono::steady_clock::now());
    return std::chrono::duration<double>(last - before).count();
  };
  if (along_paths_) {
    along_paths_->integrate(rays, radiance_, kPaddedBlock, transmittance_, counters_.medium);
    mix_nodes(rays);
    const double before =
        std::exchange(counters_.stages.surfaces, along_paths_->seconds_surfaces());
    counters_.stages.medium += lap() - (counters_.stages.surfaces - before);
    return;
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
  plan_.medium->integrate(batch, options, out, counters_.medium);
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

/// Integrates rays by the table, which some of them correct.
/// @return false without a table, or with too few samples for it
template <class Real>
bool RadianceIntegrator<Real>::integrate_by_table([[maybe_unused]] const TracedRays<Real>& rays) {
  if constexpr (std::is_same_v<Real, float>) {
    if (!plan_.table) return false;
    const SobolPool& pool = plan_.pools().front();
    if (pool.replicates() * pool.points() < plan_.table->least_samples()) return false;
    if (!table_worker_) table_worker_ = std::make_unique<RadianceTable::Worker>(*plan_.table);
    const auto set = [&](float* factors, int one_of) {
      std::fill_n(factors, rays.padded, 0.F);
      for (const PixelRays& pixel : rays.pixels) {
        const int points = pixel.points;
        const auto [corrected, factor] = corrections(points, one_of);
        int left = 0;
        for (int i = 0; i < pixel.count; i += left) {
          const int place = (pixel.offset + i) % points, replicate = (pixel.offset + i) / points;
          left = std::min(points - place, pixel.count - i);
          if (points < one_of && !is_corrected(pixel, replicate, plan_.points.first, one_of))
            continue;
          const int until = std::min(left, corrected - place);
          for (int k = 0; k < until; ++k) factors[pixel.first + i + k] = factor;
        }
      }
    };
    set(transmittance_, kSmoothRays);  // nothing else needs this array here
    set(fair_factor_, kFairRays);
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
