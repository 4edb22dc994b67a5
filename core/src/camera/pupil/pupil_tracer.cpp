#include "camera/pupil/pupil_tracer.h"

#include <algorithm>
#include <cmath>

#include "plenoflame/base/constants.h"

namespace plenoflame {
namespace {

constexpr std::size_t kPadded = kBlockRays + kBlockSlack;

}  // namespace

PupilTracer::PupilTracer(const Camera& camera, int type, bool open)
    : lens_(kernel_microlenses<double>(camera)[static_cast<std::size_t>(type)]),
      camera_(kernel_camera<double>(camera.undistorted(), {0, 0, 0}, RigidTransform{})),
      kernels_(camera_kernels<double>(best_isa())),
      storage_(7 * kPadded + 8),
      codes_(kPadded) {
  if (open) {
    for (KernelSurface<double>& surface : lens_.surfaces) {
      // Not beyond the sphere itself, with some margin.
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
  trace_at({h, 0}, lens_, {1, 0}, requests, answer);
}

void PupilTracer::start(const std::vector<Request>& requests, std::size_t first, std::size_t count,
                        double z, Vec2 turn) {
  const std::size_t padded = (count + 15) / 16 * 16;
  for (std::size_t i = 0; i < padded; ++i) {
    const Request& request = requests[first + std::min(i, count - 1)];
    const Vec2 way = request.u - request.s;
    const double x = turn.x * way.x - turn.y * way.y, y = turn.y * way.x + turn.x * way.y;
    const double inverse = 1 / std::sqrt(x * x + y * y + z * z);
    block_.x[i] = turn.x * request.u.x - turn.y * request.u.y;
    block_.y[i] = turn.y * request.u.x + turn.x * request.u.y;
    block_.z[i] = 0;
    block_.dx[i] = x * inverse;
    block_.dy[i] = y * inverse;
    block_.dz[i] = z * inverse;
    block_.weight[i] = 1;
    block_.code[i] = 0;
  }
}

Ray PupilTracer::ray(std::size_t i) const {
  return {{block_.x[i], block_.y[i], block_.z[i]}, {block_.dx[i], block_.dy[i], block_.dz[i]}};
}

void PupilTracer::trace_at(Vec2 place, const KernelMicrolens<double>& lens, Vec2 turn,
                           const std::vector<Request>& requests, const Answer& answer) {
  for (std::size_t first = 0; first < requests.size(); first += kBlockRays) {
    const std::size_t count = std::min<std::size_t>(kBlockRays, requests.size() - first);
    start(requests, first, count, lens.distance, turn);
    kernels_.pass_microlens(lens, place.x, place.y, 0, static_cast<int>(count), block_);
    kernels_.trace_lens(camera_, static_cast<int>((count + 15) / 16 * 16), block_);
    for (std::size_t i = 0; i < count; ++i) answer(first + i, block_.code[i] == 0, ray(i));
  }
}

void PupilTracer::leave_microlens(const std::vector<Request>& requests,
                                  const Emergence& emergence) {
  for (std::size_t first = 0; first < requests.size(); first += kBlockRays) {
    const std::size_t count = std::min<std::size_t>(kBlockRays, requests.size() - first);
    start(requests, first, count, lens_.distance, {1, 0});
    kernels_.pass_microlens(lens_, 0, 0, 0, static_cast<int>(count), block_);
    for (std::size_t i = 0; i < count; ++i) emergence(first + i, block_.code[i] == 0, ray(i));
  }
}

MisalignedPupilTracer::MisalignedPupilTracer(const Camera& camera, int type)
    : PupilTracer(camera, type, false), misaligned_(camera), type_(type) {}

void MisalignedPupilTracer::trace(double h, const std::vector<Request>& requests,
                                  const Answer& answer) {
  // Kronecker sequence: covers all azimuths, each with all focal lengths of their range.
  turn_ += 0.7548776662466927, factor_ += 0.5698402909980532;
  turn_ -= std::floor(turn_), factor_ -= std::floor(factor_);
  trace_again(h, requests, answer);
}

void MisalignedPupilTracer::trace_again(double h, const std::vector<Request>& requests,
                                        const Answer& answer) {
  const double angle = 2 * constants::pi * turn_;
  const Vec2 turn{std::cos(angle), std::sin(angle)};
  const Vec2 place = misaligned_.foot() + h * turn;
  KernelMicrolens<double> lens = lens_;
  const double jitter = misaligned_.spec().array.focal_jitter;
  const double power = 1 / (1 + jitter * std::clamp(2.2 * factor_ - 1.1, -1.0, 1.0));
  lens.ideal.power *= power;
  for (KernelSurface<double>& surface : lens.surfaces) surface.curvature *= power;
  if (misaligned_.array_tilted()) set_tilt(misaligned_, type_, place, lens);
  trace_at(place, lens, turn, requests, answer);
}

}  // namespace plenoflame
