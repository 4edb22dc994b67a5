#pragma once
#include <array>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/media/voxel_medium.h"

/// Sparse voxel fields as full arrays on a lattice, and back: what images of VTK and arrays of
/// numpy hold. Values run along i fastest, then j, then k.
namespace plenoflame {

/// Whole index coordinates, both ends included; empty when a lower one exceeds its upper one.
struct IndexBox {
  std::array<int, 3> lower{0, 0, 0}, upper{-1, -1, -1};
  bool empty() const { return lower[0] > upper[0]; }
  void add(const IndexBox& other);
  std::array<std::size_t, 3> size() const;
};

/// The places of an array's samples. Sample (i, j, k) is at the origin plus the sum of i, j, k
/// times spacing times direction along each axis.
struct VoxelPlace {
  std::array<std::size_t, 3> size{};
  Vec3 origin;                         ///< [m] world
  std::array<double, 3> spacing{};     ///< [m]
  std::array<Vec3, 3> direction = {};  ///< unit vectors; at right angles unless sheared
};

/// A named array on such a lattice.
struct VoxelArray {
  std::string name;
  std::vector<float> values;
};

/// Box around every voxel that differs from the background.
IndexBox stored_box(const VoxelField& field);

/// The lattice of a transform within a box. Spacing and direction are the columns of the map's
/// linear part, so that rotation, and shear, are kept.
VoxelPlace voxel_place(const AffineTransform& transform, const IndexBox& box);

/// Values of a field in a box of its lattice; outside of stored voxels the background.
VoxelArray voxel_values(const VoxelField& field, const IndexBox& box);

/// A field's values interpolated trilinearly at the samples of another lattice.
VoxelArray interpolated_values(const VoxelField& field, const AffineTransform& transform,
                               const IndexBox& box);

/// Fields on the lattice of the first one.
struct LatticeFields {
  AffineTransform transform;
  IndexBox box;
  std::vector<VoxelArray> arrays;
};
/// Fields of other lattices are interpolated, with a warning. @param file for messages; empty: none
/// @param alone how the caller reads a single grid @throws InputError for a flame without values
LatticeFields on_one_lattice(const std::vector<VoxelField>& fields, const std::string& file,
                             const std::string& alone, const Execution& execution);

/// Samples of an array as voxels; bricks that hold only the background are left out.
/// @param value of sample n, in the order of the values
VoxelField voxels_of(const VoxelPlace& place, const std::string& name, float background,
                     const std::function<float(std::size_t n)>& value);

/// Refuses values that no flame has. @throws InputError naming array and voxel: not finite, or
/// negative
void check_flame_values(const VoxelField& field);

}  // namespace plenoflame
