#include "render/tracer/ray_generator.h"

#include <iterator>

namespace plenoflame {

template <class Real>
RayGenerator<Real>::RayGenerator(const BackwardPlan<Real>& plan, RayConsumer<Real>& consumer,
                                 WorkCounters& counters)
    : plan_(plan),
      tracer_(plan, consumer, counters),
      counters_(counters),
      keeps_groups_(plan.surfaces || plan.scatter),
      queued_(kBlockRays + 1),  // a pixel has at least one ray
      pending_(kBlockRays),
      columns_(plan.scene->camera.pupil_filters().empty() ? 9 : 11),
      codes_(kPaddedBlock) {
  Real** arrays[] = {&block_.x,  &block_.y,      &block_.z,          &block_.dx,        &block_.dy,
                     &block_.dz, &block_.weight, &block_.scratch[0], &block_.scratch[1]};
  for (std::size_t i = 0; i < std::size(arrays); ++i) *arrays[i] = columns_[i];
  block_.code = codes_.data();
  if (plan.scene->camera.pupil_filters().empty()) return;
  block_.stop_x = columns_[9];
  block_.stop_y = columns_[10];
}

template <class Real>
void RayGenerator<Real>::draw() {
  if (queued_count_ == 0) return;
  plan_.kernels.generate(target_.frame, queued_.data(), queued_count_,
                         target_.optics(plan_).distance, block_);
  const KernelPixel<Real>& last = queued_[static_cast<std::size_t>(queued_count_ - 1)];
  const int first = queued_.front().first;
  tracer_.pass_microlens(target_, first, last.first + last.count - first, block_);
  queued_count_ = 0;
}

/// Makes room for the rays of this pixel, which is queued afterwards.
template <class Real>
void RayGenerator<Real>::flush_keeping(const KernelPixel<Real>& made) {
  const KernelPixel<Real> kept = made;
  flush();
  pixel() = kept;
}

template <class Real>
void RayGenerator<Real>::flush() {
  draw();
  if (count_ == 0) return;
  const int padded = (count_ + kRayPadding - 1) / kRayPadding * kRayPadding;
  for (int i = count_; i < padded; ++i) {
    block_.x[i] = block_.x[0];
    block_.y[i] = block_.y[0];
    block_.z[i] = block_.z[0];
    block_.dx[i] = block_.dx[0];
    block_.dy[i] = block_.dy[0];
    block_.dz[i] = block_.dz[0];
    block_.weight[i] = 0;
    block_.code[i] = 1;
  }
  tracer_.trace({block_,
                 count_,
                 padded,
                 {pending_.data(), static_cast<std::size_t>(pending_count_)},
                 groups_,
                 log2_points_});
  groups_.clear();
  pending_count_ = 0;
  log2_points_ = 0;
  count_ = 0;
}

template class RayGenerator<float>;
template class RayGenerator<double>;

}  // namespace plenoflame
