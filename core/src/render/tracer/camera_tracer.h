#pragma once
#include <optional>

#include "plenoflame/render/work_counters.h"
#include "render/tracer/backward_plan.h"
#include "render/tracer/traced_rays.h"

namespace plenoflame {

/// The microlens that drawn rays aim at, or the aim plane in its place.
template <class Real>
struct RayTarget {
  KernelFrame<Real> frame{};
  LensIndex lens;  ///< (0, 0): none
  int type = 0;    ///< of the microlens, an index of BackwardPlan::microlenses
  std::optional<KernelMicrolens<Real>> own;  ///< set if lenses of the type differ

  const KernelMicrolens<Real>& optics(const BackwardPlan<Real>& plan) const {
    return own ? *own : plan.microlenses[static_cast<std::size_t>(type)];
  }
};

/// Takes drawn rays through microlens and main lens to a consumer.
template <class Real>
class CameraTracer {
 public:
  /// All arguments are kept by reference. @param counters of rays and of the optics' seconds
  CameraTracer(const BackwardPlan<Real>& plan, RayConsumer<Real>& consumer, WorkCounters& counters)
      : plan_(plan),
        consumer_(consumer),
        shows_drawn_(consumer.wants_drawn()),
        counters_(counters) {}

  /// Takes rays [first, first + count) of the block through the microlens that they aim at.
  void pass_microlens(const RayTarget<Real>& target, int first, int count,
                      const KernelBlock<Real>& block);
  /// Takes a block through the main lens into the world, and hands it to the consumer.
  void trace(const TracedRays<Real>& rays);

 private:
  void end_at_microlenses(int first, int count, const KernelBlock<Real>& block) const;

  const BackwardPlan<Real>& plan_;
  RayConsumer<Real>& consumer_;
  const bool shows_drawn_;
  WorkCounters& counters_;
};

}  // namespace plenoflame
