// Data and entry points of the kernels that cut rays into intervals at the faces of cells, and
// weigh the light of the intervals' nodes.
#pragma once

#include "plenoflame/media/ray_interval_kernel.h"

namespace plenoflame {

/// A lattice in index coordinates, in which cell (i, j, k) begins at these numbers.
struct KernelLattice {
  int count[3];                       ///< samples
  int low[3], high[3];                ///< cells
  int corner[RayInterval::kCorners];  ///< numbers of a cell's samples, from its lowest one on
  bool is_linear;
};

/// A line in index coordinates, from t = from to t = to within the cells.
struct KernelLine {
  double origin[3], direction[3], from, to;
};

/// Arrays by interval (IntervalTransfers).
struct KernelTransfers {
  const double *near_depth, *far_depth;
  double *transmittance, *near, *far;
};

#define PLENOFLAME_INTERVAL_KERNELS                                                            \
  /* Cuts a line at the faces of cells. `out` has room for one interval per face and two more. \
   */                                                                                          \
  int cut_at_cells(const KernelLattice&, const KernelLine&, RayInterval* out);                 \
  /* Optical depths of the halves of both nodes. */                                            \
  void add_up_depths(const RayInterval*, int count, const double* absorption, double ratio,    \
                     double* near, double* far);                                               \
  /* Weights on source functions, or on emission per length. */                                \
  void weigh_nodes(bool emission, int count, const KernelTransfers&);                          \
  /* See sum_nodes(). */                                                                       \
  void sum_nodes(RayInterval*, int count, double factor, const double* near, const double* far);

namespace baseline {
PLENOFLAME_INTERVAL_KERNELS
}
namespace avx2 {
PLENOFLAME_INTERVAL_KERNELS
}
namespace avx512 {
PLENOFLAME_INTERVAL_KERNELS
}

}  // namespace plenoflame
