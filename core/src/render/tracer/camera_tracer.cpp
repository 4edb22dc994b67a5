#include "render/tracer/camera_tracer.h"

#include <chrono>

#include "render/run/run_control.h"

namespace plenoflame {

template <class Real>
void CameraTracer<Real>::pass_microlens(const RayTarget<Real>& target, int first, int count,
                                        const KernelBlock<Real>& block) {
  const KernelMicrolens<Real>& lens = target.optics(plan_);
  const bool between = target.type == plan_.between_type;
  if (shows_drawn_)
    consumer_.drawn({target.frame, target.lens, between || lens.kind == 0 ? -1 : target.type, block,
                     first, count});
  if (between) end_at_microlenses(first, count, block);
  // Between the lenses, rays pass only the sensor's cover glass.
  plan_.optics.pass_microlens(lens, target.frame.lens_x, target.frame.lens_y, first, count, block);
}

/// Ends rays that were drawn without an array and meet one of its lenses.
template <class Real>
void CameraTracer<Real>::end_at_microlenses(int first, int count,
                                            const KernelBlock<Real>& block) const {
  const Camera& camera = plan_.scene->camera;
  const int front = camera.surface_count() - (camera.ideal_array() ? 1 : 2);
  const double z = camera.array_front() + static_cast<double>(plan_.between_z);
  for (int i = first; i < first + count; ++i) {
    const Ray ray{{static_cast<double>(block.x[i]), static_cast<double>(block.y[i]), z},
                  {static_cast<double>(block.dx[i]), static_cast<double>(block.dy[i]),
                   static_cast<double>(block.dz[i])}};
    block.z[i] = plan_.between_z;
    if (!camera.passes_between(ray)) block.code[i] = 4 * front + kCauseVignetted;
  }
}

template <class Real>
void CameraTracer<Real>::trace(const TracedRays<Real>& rays) {
  const auto start = std::chrono::steady_clock::now();
  plan_.optics.trace_lens(plan_.camera, rays.padded, rays.block);
  counters_.rays += rays.count;
  counters_.rays_reached +=
      plan_.optics.count_alive(rays.block.code, rays.block.weight, rays.count);
  counters_.stages.optics += seconds_since(start);
  consumer_.traced(rays);
}

template class CameraTracer<float>;
template class CameraTracer<double>;

}  // namespace plenoflame
