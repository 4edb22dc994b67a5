#include "camera/pupil_tracer.h"

#include <algorithm>
#include <cmath>

namespace plenoflame {
namespace {

constexpr std::size_t kPadded = kBlockRays + kBlockSlack;

}  // namespace

PupilTracer::PupilTracer(const Camera& camera, int type, bool open)
    : camera_(kernel_camera<double>(camera, {0, 0, 0}, RigidTransform{})),
      lens_(kernel_microlenses<double>(camera)[static_cast<std::size_t>(type)]),
      kernels_(camera_kernels<double>(best_isa())),
      storage_(7 * kPadded + 8),
      codes_(kPadded) {
  if (open) {
    for (KernelSurface<double>& surface : lens_.surfaces) {
      // No further than the sphere itself reaches, with some room.
      const double c = surface.curvature;
      surface.aperture2 = c != 0 ? 0.9 / (c * c) : kInfinity;
    }
    lens_.ideal.stop_radius2 = kInfinity;
  }
  double* base = storage_.data();
  while (reinterpret_cast<std::uintptr_t>(base) % 64 != 0) ++base;
  double** arrays[] = {&block_.x,  &block_.y,  &block_.z,     &block_.dx,
                       &block_.dy, &block_.dz, &block_.weight};
  for (double** array : arrays) {
    *array = base;
    base += kPadded;
  }
  block_.code = codes_.data();
}

void PupilTracer::trace(double h, const std::vector<Request>& requests, const Answer& answer) {
  for (std::size_t first = 0; first < requests.size(); first += kBlockRays) {
    const std::size_t count = std::min<std::size_t>(kBlockRays, requests.size() - first);
    const std::size_t padded = (count + 15) / 16 * 16;
    const double z = lens_.distance;
    for (std::size_t i = 0; i < padded; ++i) {
      const Request& request = requests[first + std::min(i, count - 1)];
      const double x = request.u.x - request.s.x, y = request.u.y - request.s.y;
      const double inverse = 1 / std::sqrt(x * x + y * y + z * z);
      block_.x[i] = request.u.x;
      block_.y[i] = request.u.y;
      block_.z[i] = 0;
      block_.dx[i] = x * inverse;
      block_.dy[i] = y * inverse;
      block_.dz[i] = z * inverse;
      block_.weight[i] = 1;
      block_.code[i] = 0;
    }
    kernels_.pass_microlens(lens_, h, 0, 0, static_cast<int>(count), block_);
    kernels_.trace_lens(camera_, static_cast<int>(padded), block_);
    for (std::size_t i = 0; i < count; ++i)
      answer(
          first + i, block_.code[i] == 0,
          Ray{{block_.x[i], block_.y[i], block_.z[i]}, {block_.dx[i], block_.dy[i], block_.dz[i]}});
  }
}

}  // namespace plenoflame
