// Data of the kernels that trace rays through walls of glass, and their entry points for every
// instruction set.
#pragma once

namespace plenoflame {

/// A wall that rays enter on one side and leave on the other.
template <class Real>
struct KernelWall {
  bool is_round;
  Real turn[9];  ///< from the world to the window's own frame, row by row
  Real at[3];    ///< the rays' anchor in that frame [m]
  Real index, absorption;
  bool reflects;
  // Flat walls: faces in the order in which rays meet them, dot(normal, p) = offset, with normals
  // out of the glass. Then the polished part of the faces [m].
  Real normal[2][3], offset[2];
  Real half_x, half_y, radius2;
  // Round walls: cylinders around z, from outside inwards.
  Real radius[2], low, high;
};

/// Lines relative to the anchor, along unit vectors in world axes.
template <class Real>
struct KernelWays {
  Real *x, *y, *z, *dx, *dy, *dz;
  Real* through;  ///< transmitted share of their light
  int* odd;       ///< nonzero: the path is not in at one face and out at the other
};

#define PLENOFLAME_WINDOW_WALL_KERNELS                                                             \
  /* Takes rays through a wall, those that pass a round one by excepted; `count` multiple of 16.   \
   */                                                                                              \
  void pass_wall(const KernelWall<float>&, int count, const KernelWays<float>&);                   \
  void pass_wall(const KernelWall<double>&, int count, const KernelWays<double>&);                 \
  /* Moves each line's point to that nearest to the anchor.                                     */ \
  void move_to_anchor(int count, const KernelWays<float>&);                                        \
  void move_to_anchor(int count, const KernelWays<double>&);

namespace baseline {
PLENOFLAME_WINDOW_WALL_KERNELS
}
namespace avx2 {
PLENOFLAME_WINDOW_WALL_KERNELS
}
namespace avx512 {
PLENOFLAME_WINDOW_WALL_KERNELS
}

}  // namespace plenoflame
