#pragma once
#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "plenoflame/math/vector.h"
#include "plenoflame/media/ray_interval_kernel.h"
#include "plenoflame/media/voxel_medium.h"

/// The voxel medium's quadrature without the sum along the ray, in double precision. Inversions
/// differentiate it (docs/theory/reconstruction.md).
namespace plenoflame {

/// Samples at whole index coordinates 0 .. count - 1 of each axis; sample (i, j, k) has the number
/// (i * count[1] + j) * count[2] + k. Outside of them the field is 0.
struct RegularLattice {
  std::array<int, 3> count{};
  AffineTransform index_to_world;
  VoxelInterpolation interpolation = VoxelInterpolation::trilinear;

  std::size_t size() const {
    return static_cast<std::size_t>(count[0]) * static_cast<std::size_t>(count[1]) *
           static_cast<std::size_t>(count[2]);
  }
  Vec3 place(std::size_t sample) const;  ///< world
};

/// The lattice whose cells fill a box along the world's axes, a sample in the middle of each.
/// @param centre, size of the box [m] @param count of samples along each axis, at least 1
RegularLattice regular_lattice(Vec3 centre, Vec3 size, const std::array<int, 3>& count);

/// The intervals of a ray, in their order along it. Memory is kept from ray to ray.
class RayIntervals {
 public:
  void clear() { size_ = 0; }
  std::size_t size() const { return size_; }
  const RayInterval& operator[](std::size_t i) const { return all_[i]; }
  RayInterval* data() { return all_.get(); }
  const RayInterval* data() const { return all_.get(); }
  const RayInterval* begin() const { return all_.get(); }
  const RayInterval* end() const { return all_.get() + size_; }

  /// Room for further intervals, without values. @return the first of them
  RayInterval* room(std::size_t count);
  /// Adds the first intervals of the room.
  void add(std::size_t count) { size_ += count; }
  /// Adds an interval with weights of 0 in the first sample.
  RayInterval& add_empty(double length);

 private:
  std::unique_ptr<RayInterval[]> all_;
  std::size_t size_ = 0, capacity_ = 0;
};

/// A field at a node of an interval.
double value_at(const RayInterval& interval, std::size_t node, std::span<const double> samples);

/// Cuts rays into intervals at the faces of a lattice's cells, as the voxel medium does.
class LatticeWalk {
 public:
  /// @throws InputError for a singular transform or an axis without samples
  explicit LatticeWalk(const RegularLattice& lattice);

  /// Appends the intervals of a ray between two places, in their order along it.
  void append(const Ray& ray, double t_near, double t_far, RayIntervals& out) const;
  const RegularLattice& lattice() const { return lattice_; }

 private:
  RegularLattice lattice_;
  Mat3 to_index_;
  std::array<int, 3> low_{}, high_{};  // cells
};

/// The kind of samples that a row of the linear problem is for.
enum class RowModel {
  emission,  ///< samples of emission [W/(m^3 sr)]: emission lines, or any other light
  source,    ///< samples of the source function [W/(m^2 sr)], emitted by the absorption
};

/// Arrays by interval: the light of two nodes at the front of their interval.
struct IntervalTransfers {
  std::vector<double> near_depth, far_depth;  ///< optical depth of the half of either node
  std::vector<double> transmittance;
  /// Weights of the nodes, on source functions or on emission per length of the interval.
  std::vector<double> near, far;

  /// @param absorption samples [1/m]; values below 0 count as 0 @param ratio on the absorption
  void set(const RayIntervals& intervals, std::span<const double> absorption, double ratio,
           RowModel model);
};

/// Derivatives of the weights on source functions with regard to the depths tau0 and tau1 of the
/// nodes' halves: [0] and [1]. The derivative of the transmittance is minus the transmittance, for
/// both. A weight that is clamped to 0 has the derivative 0.
struct TransferSlopes {
  std::array<double, 2> near{}, far{};  ///< of the weights on source functions
};
TransferSlopes transfer_slopes(double tau0, double tau1);

/// Weights of the intervals' nodes. The radiance at the ray's near end is the sum over all nodes of
/// their weight times the field there.
/// @param absorption samples [1/m]; empty: none
/// @param weights `near` and `far` receive the weights; the rest is temporary storage
/// @return transmittance of all intervals
double node_weights(const RayIntervals& intervals, std::span<const double> absorption,
                    RowModel model, IntervalTransfers& weights);

/// Sums the nodes of each interval: weight[0] becomes factor * (near * weight[0] + far *
/// weight[1]), with the interval's `near` and `far`.
void sum_nodes(double factor, const IntervalTransfers& weights, RayIntervals& intervals);

}  // namespace plenoflame
