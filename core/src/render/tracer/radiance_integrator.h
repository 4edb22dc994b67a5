#pragma once
#include <memory>

#include "render/sampling/aligned_columns.h"
#include "render/tracer/backward_plan.h"
#include "render/tracer/path_integrator.h"
#include "render/tracer/radiance_table.h"
#include "render/tracer/traced_rays.h"

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
  /// The integrator of paths in the world; nullptr if the plan takes lines.
  const PathIntegrator<Real>* along_paths() const { return along_paths_.get(); }
  /// Counts of medium and table, and the seconds of medium and surfaces.
  const WorkCounters& counters() const { return counters_; }

 private:
  void integrate_rays(const TracedRays<Real>& rays);
  bool integrate_by_table(const TracedRays<Real>& rays);
  void mix_nodes(const TracedRays<Real>& rays);
  void filter(const TracedRays<Real>& rays);

  const BackwardPlan<Real>& plan_;
  AlignedColumns<Real> columns_;
  Real* radiance_ = nullptr;
  Real* transmittance_ = nullptr;
  Real* fair_factor_ = nullptr;
  std::unique_ptr<PathIntegrator<Real>> along_paths_;
  std::unique_ptr<RadianceTable::Worker> table_worker_;
  WorkCounters counters_;
  std::vector<int> pupil_parts_;  ///< of the rays of a block
};

}  // namespace plenoflame
