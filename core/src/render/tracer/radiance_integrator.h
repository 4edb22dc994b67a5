#pragma once
#include <memory>

#include "render/sampling/aligned_columns.h"
#include "render/tracer/backward_plan.h"
#include "render/tracer/backward_surfaces.h"
#include "render/tracer/radiance_table.h"
#include "render/tracer/traced_rays.h"
#include "render/tracer/window_integrator.h"
#include "render/transport/scatter_walk.h"

namespace plenoflame {

/// Finds the radiance that arrives along the rays of a block. Its sources are the flames, surfaces
/// and surroundings behind them, and light that is scattered into the rays. One object per worker
/// thread.
template <class Real>
class RadianceIntegrator {
 public:
  /// @param plan kept by reference
  explicit RadianceIntegrator(const BackwardPlan<Real>& plan);

  void integrate(const TracedRays<Real>& rays);
  /// [W/(m^2 sr)] of the last integrated block, channel c of ray i at [c * kPaddedBlock + i].
  const Real* radiance() const { return radiance_; }
  /// The flames' transmittance in the first channel, by ray; undefined if a table replaces them.
  const Real* transmittance() const { return transmittance_; }
  /// The distance at which each ray ends at a solid surface, in the precision of the block [m];
  /// nullptr without surfaces. Not for rays through windows.
  const Real* ends() const { return surfaces_ ? surfaces_->t_far() : nullptr; }
  /// The integrator of scenes with windows, else nullptr.
  const WindowIntegrator<Real>* windows() const { return windows_.get(); }
  /// Counts of medium and table, and the seconds of medium and surfaces.
  const WorkCounters& counters() const { return counters_; }

 private:
  void integrate_rays(const TracedRays<Real>& rays);
  bool integrate_by_table(const TracedRays<Real>& rays);
  void add_scattered(const TracedRays<Real>& rays);
  void mix_nodes(const TracedRays<Real>& rays);
  void filter(const TracedRays<Real>& rays);

  const BackwardPlan<Real>& plan_;
  AlignedColumns<Real> columns_;
  Real* radiance_ = nullptr;
  Real* transmittance_ = nullptr;
  int transmittance_stride_ = 0;  ///< between nodes; 0: one value for all nodes
  Real* fair_factor_ = nullptr;
  std::unique_ptr<ScatterWalk> scatter_;             ///< nullptr: nothing scatters
  std::unique_ptr<SurfaceBlock<Real>> surfaces_;     ///< nullptr if the plan has none
  std::unique_ptr<WindowIntegrator<Real>> windows_;  ///< nullptr: no windows
  std::unique_ptr<RadianceTable::Worker> table_worker_;
  WorkCounters counters_;
  std::vector<int> pupil_parts_;  ///< of the rays of a block
};

}  // namespace plenoflame
