#pragma once
#include <vector>

#include "plenoflame/film/film.h"
#include "render/sampling/aligned_columns.h"
#include "render/tracer/backward_plan.h"
#include "render/tracer/radiance_table.h"
#include "render/tracer/traced_rays.h"

namespace plenoflame {

/// Adds weight * radiance of the rays of a block to the sums of a film's tile, each ray to its own
/// replicate. One object per worker thread.
template <class Real>
class FilmSums {
 public:
  /// @param plan and film are kept by reference
  FilmSums(const BackwardPlan<Real>& plan, Film& film);
  void begin_tile(int index, const PixelWindow& tile);
  /// @param radiance channel c of ray i at [c * kPaddedBlock + i]
  void add(const TracedRays<Real>& rays, const Real* radiance);
  /// Counts of sums that a table's corrections made negative: clamped, clamped_sum and total.
  const TableCounters& table_counters() const { return table_; }

 private:
  double not_negative(double sum, double scale);
  void sum_rays(const TracedRays<Real>& rays, const Real* radiance);
  void add_channel(const TracedRays<Real>& rays, int channel, const Real* radiance);

  const BackwardPlan<Real>& plan_;
  Film& film_;
  int tile_index_ = 0;
  PixelWindow tile_;
  /// The light of each ray of the block, and the sums of 2, 4 and 8 rays from each ray on.
  std::vector<std::vector<Real>> sums_of_rays_;
  TableCounters table_;
};

}  // namespace plenoflame
