#include "render/transport/medium_segments.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "plenoflame/math/ray_span.h"

namespace plenoflame {

template <class Real>
BasicMediumSegments<Real>::BasicMediumSegments(const Medium* medium, const MediumOptions& options)
    : medium_(medium), options_(options) {
  if (!medium) return;
  bounds_ = medium->bounds();
  channels_ = static_cast<std::size_t>(medium->channel_count());
  passes_ = medium->is_grey() ? 1 : channels_;
}

/// Tells whether a stretch meets the medium's bounds.
template <class Real>
bool BasicMediumSegments<Real>::meets(const Ray& ray, double t_far) const {
  return !clip_to_box(bounds_, ray, 0, t_far).empty();
}

template <class Real>
void BasicMediumSegments<Real>::integrate(bool with_radiance, MediumCounters& counters) {
  transmittance_.assign(rays_.size() * passes_, 1.0);
  if (with_radiance) radiance_.assign(rays_.size() * channels_, 0.0);
  if (!medium_ || bounds_.empty()) return;
  inside_.clear();
  for (std::size_t i = 0; i < rays_.size(); ++i)
    if (meets(rays_[i], far_[i])) inside_.push_back(i);
  for (std::size_t i = 0; i < inside_.size(); i += kMaxBatch)
    integrate_batch(i, std::min<std::size_t>(kMaxBatch, inside_.size() - i), with_radiance,
                    counters);
}

template <class Real>
void BasicMediumSegments<Real>::integrate_batch(std::size_t first, std::size_t count,
                                                bool with_radiance, MediumCounters& counters) {
  constexpr std::size_t kArrays = 8, kAlignment = 64 / sizeof(Real);
  storage_.resize((kArrays + passes_ + channels_) * kMaxBatch + kAlignment);
  Real* base = storage_.data();
  while (reinterpret_cast<std::uintptr_t>(base) % 64 != 0) ++base;
  Real* array[kArrays];
  for (Real*& a : array) {
    a = base;
    base += kMaxBatch;
  }
  const std::size_t padded = (count + kRayPadding - 1) / kRayPadding * kRayPadding;
  RayBatch<Real> batch;
  batch.size = static_cast<int>(padded);
  batch.anchor = 0.5 * (bounds_.lower + bounds_.upper);
  for (std::size_t i = 0; i < padded; ++i) {
    const std::size_t segment = inside_[first + std::min(i, count - 1)];
    const Vec3 d = rays_[segment].direction;
    // The point of the line nearest to the anchor, from which kernels count.
    const Vec3 o = rays_[segment].origin - batch.anchor;
    const double shift = -dot(o, d);
    const Vec3 p = o + shift * d;
    const double values[8] = {p.x, p.y, p.z, d.x, d.y, d.z, -shift, far_[segment] - shift};
    for (std::size_t k = 0; k < 8; ++k) array[k][i] = static_cast<Real>(values[k]);
  }
  batch.x = array[0], batch.y = array[1], batch.z = array[2];
  batch.dx = array[3], batch.dy = array[4], batch.dz = array[5];
  batch.t_near = array[6], batch.t_far = array[7];
  RadianceBatch<Real> out;
  Real* const passed = base;
  base += passes_ * kMaxBatch;
  out.radiance = base;
  out.stride = kMaxBatch;
  out.transmittance = passed;
  if (passes_ > 1) out.transmittance_stride = kMaxBatch;
  medium_->integrate(batch, options_, out, counters);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t segment = inside_[first + i];
    for (std::size_t p = 0; p < passes_; ++p)
      transmittance_[segment * passes_ + p] = static_cast<double>(passed[p * kMaxBatch + i]);
    if (!with_radiance) continue;
    for (std::size_t c = 0; c < channels_; ++c)
      radiance_[segment * channels_ + c] = static_cast<double>(base[c * kMaxBatch + i]);
  }
}

template class BasicMediumSegments<float>;
template class BasicMediumSegments<double>;

}  // namespace plenoflame
