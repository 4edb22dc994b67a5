#pragma once
#include <cstdint>
#include <vector>

#include "plenoflame/math/vector.h"
#include "plenoflame/scene/array_spec.h"

namespace plenoflame {

/// Name of one microlens: axial coordinates of the lattice (DESIGN.md, section 2).
struct LensIndex {
  int q = 0, r = 0;
  friend bool operator==(const LensIndex&, const LensIndex&) = default;
};

/// The smaller and the larger one of an array's pitches along x and y [m].
double shortest_pitch(const ArraySpec& array);
double longest_pitch(const ArraySpec& array);
/// Tells whether rows have the distance of columns, or that of a hexagonal lattice.
bool is_regular(const ArraySpec& array);

/// The lattice of microlens centres in the array's plane, camera x, y [m], with the displacements
/// of ArraySpec::centre_jitter. Without ArraySpec::columns and rows it has no edge: as many lenses
/// as light can reach the sensor through.
class MicrolensLattice {
 public:
  MicrolensLattice() = default;
  explicit MicrolensLattice(const ArraySpec& array);

  Vec2 centre(LensIndex lens) const;
  /// Factor on the radii (or the focal length) of a lens: ArraySpec::focal_jitter.
  double focal_factor(LensIndex lens) const;
  /// Type of a lens, 0 based: (q - r) mod the number of types.
  int type(LensIndex lens) const;
  /// Tells whether the array has this lens. An array of C columns and R rows is centred on lens (0,
  /// 0). It has rows -(R - 1) / 2 to R / 2 and as many columns, counted from the row's first lens
  /// right of camera y. Divisions are integer divisions, and the count precedes the array's
  /// rotation and shift.
  bool has(LensIndex lens) const;
  /// The lens of the array whose centre is nearest to a point.
  LensIndex nearest(Vec2 point) const;
  /// All lenses with centres in the closed rectangle, ordered by r, then q.
  std::vector<LensIndex> within(Vec2 lower, Vec2 upper) const;

 private:
  Vec2 axial(Vec2 point) const;
  LensIndex nearest_place(Vec2 point) const;
  int column(LensIndex lens) const;
  Vec2 displacement(LensIndex lens) const;
  Vec2 step_q_{1, 0}, step_r_{0, 1}, offset_;
  double jitter_ = 0;  ///< [m] greatest displacement of a lens from its place
  double focal_jitter_ = 0;
  std::uint64_t jitter_seed_ = 1;
  int type_count_ = 1;
  int columns_ = 0, rows_ = 0;  ///< 0: without end
  bool hexagonal_ = false;
};

}  // namespace plenoflame
