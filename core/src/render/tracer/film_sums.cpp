#include "render/tracer/film_sums.h"

#include <algorithm>

namespace plenoflame {

template <class Real>
FilmSums<Real>::FilmSums(const BackwardPlan<Real>& plan, Film& film)
    : plan_(plan),
      film_(film),
      sums_of_rays_(kMostLog2Points + 1, std::vector<Real>(kPaddedBlock)) {}

template <class Real>
void FilmSums<Real>::begin_tile(int index, const PixelWindow& tile) {
  tile_index_ = index;
  tile_ = tile;
}

template <class Real>
void FilmSums<Real>::add(const TracedRays<Real>& rays, const Real* radiance) {
  const auto channels = static_cast<int>(plan_.scene->scene.channels.size());
  for (int channel = 0; channel < channels; ++channel)
    add_channel(rays, channel, radiance + channel * kPaddedBlock);
}

/// Replaces a negative sum by 0 and counts the difference, which bounds the bias. A table with too
/// large values is corrected by few rays with large weights. The sum over all rays can then become
/// negative, unlike light.
template <class Real>
double FilmSums<Real>::not_negative(double sum, double scale) {
  TableCounters& table = table_;
  if (sum < 0) {
    table.clamped += 1;
    table.clamped_sum -= scale * sum;
    sum = 0;
  }
  table.total += scale * sum;
  return sum;
}

/// Sums the rays of few points. Adding each ray on its own would need branches that the processor
/// could not predict.
template <class Real>
void FilmSums<Real>::sum_rays(const TracedRays<Real>& rays, const Real* radiance) {
  Real* sums = sums_of_rays_[0].data();
  plan_.kernels.multiply(rays.block.weight, radiance, rays.count, sums);
  for (std::size_t k = 1; k <= static_cast<std::size_t>(rays.log2_points); ++k) {
    Real* const more = sums_of_rays_[k].data();
    plan_.kernels.add_neighbours(sums, 1 << (k - 1), rays.count, more);
    sums = more;
  }
}

template <class Real>
void FilmSums<Real>::add_channel(const TracedRays<Real>& rays, int channel, const Real* radiance) {
  const auto replicates = static_cast<std::size_t>(film_.replicates());
  const auto width = static_cast<std::size_t>(tile_.width);
  const std::size_t stride = width * static_cast<std::size_t>(tile_.height);
  const std::vector<int>& place = plan_.scene->film_channel;
  const auto of_film =
      static_cast<std::size_t>(place.empty() ? channel : place[static_cast<std::size_t>(channel)]);
  double* const sums = film_.tile_sums(tile_index_).data() + of_film * replicates * stride;
  sum_rays(rays, radiance);
  for (const PixelRays& pending : rays.pixels) {
    const int points = pending.points;
    const double scale = pending.scale;
    double* const pixel = sums + static_cast<std::size_t>(pending.row - tile_.y) * width +
                          static_cast<std::size_t>(pending.column - tile_.x);
    // The usual case: all replicates, of 1, 2, 4 or 8 points.
    const bool few = pending.log2_points >= 0;
    const Real* const sums_from =
        sums_of_rays_[static_cast<std::size_t>(few ? pending.log2_points : 0)].data();
    if (few && pending.count == points * film_.replicates() && !plan_.table) {
      for (std::size_t r = 0; r < replicates; ++r)
        pixel[r * stride] +=
            scale * static_cast<double>(sums_from[pending.first + static_cast<int>(r) * points]);
      continue;
    }
    std::size_t replicate = static_cast<std::size_t>(pending.offset / points);
    int left = points - pending.offset % points;
    for (int i = pending.first; i < pending.first + pending.count; ++replicate, left = points) {
      const int end = std::min(pending.first + pending.count, i + left);
      // Blocks hold all points of a replicate with few points.
      static_assert(kBlockRays % (1 << kMostLog2Points) == 0);
      double sum = few ? static_cast<double>(sums_from[i])
                       : plan_.kernels.sum(rays.block.weight + i, radiance + i, end - i);
      i = end;
      if (plan_.table) sum = not_negative(sum, scale);
      pixel[replicate * stride] += scale * sum;
    }
  }
}

template class FilmSums<float>;
template class FilmSums<double>;

}  // namespace plenoflame
