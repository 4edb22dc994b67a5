#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "plenoflame/math/vector.h"
#include "plenoflame/media/voxel_medium.h"

/// The voxel medium's quadrature without the sum along the ray, for one ray at a time in double
/// precision. Inversions differentiate it (docs/theory/reconstruction.md).
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

/// A quadrature node of an interval: a field there is the sum of weight * sample. Entries from
/// `count` on have no value.
struct RayNode {
  int count = 0;
  std::array<std::uint32_t, 8> sample;
  std::array<double, 8> weight;

  double value(std::span<const double> samples) const {
    double sum = 0;
    for (int i = 0; i < count; ++i)
      sum += weight[static_cast<std::size_t>(i)] * samples[sample[static_cast<std::size_t>(i)]];
    return sum;
  }
};

/// A part of a ray within one cell, with the two nodes of the Gauss rule, the nearer one first.
struct RayInterval {
  double length = 0;  ///< [m]
  std::array<RayNode, 2> node;
};

/// Places of the two nodes, in lengths of the interval: 1/2 -+ 1/(2 sqrt 3).
inline constexpr std::array<double, 2> kGaussNodes{0.21132486540518711775, 0.78867513459481288225};

/// Cuts rays into intervals at the faces of a lattice's cells, as the voxel medium does.
class LatticeWalk {
 public:
  /// @throws InputError for a singular transform or an axis without samples
  explicit LatticeWalk(const RegularLattice& lattice);

  /// Appends the intervals of a ray between two places, in their order along it.
  void append(const Ray& ray, double t_near, double t_far, std::vector<RayInterval>& out) const;
  const RegularLattice& lattice() const { return lattice_; }

 private:
  void set_node(const std::array<int, 3>& cell, const std::array<double, 3>& place,
                RayNode& node) const;

  RegularLattice lattice_;
  Mat3 to_index_;
  std::array<int, 3> low_{}, high_{};  // cells
};

/// Weights of the light of two nodes at the front of their interval.
struct IntervalTransfer {
  double transmittance = 1;
  double near = 0, far = 0;            ///< on source functions
  double line_near = 0, line_far = 0;  ///< on emission, per length of the interval
};
/// @param tau0, tau1 half the interval's length times the absorption at either node
IntervalTransfer interval_transfer(double tau0, double tau1);

/// Derivatives of interval_transfer()'s weights with regard to tau0 and tau1: [0] and [1]. The
/// derivative of the transmittance is minus the transmittance, for both. A weight that is clamped
/// to 0 has the derivative 0.
struct TransferSlopes {
  std::array<double, 2> near{}, far{};  ///< of the weights on source functions
};
TransferSlopes transfer_slopes(double tau0, double tau1);

/// The kind of samples that a row of the linear problem is for.
enum class RowModel {
  emission,  ///< samples of emission [W/(m^3 sr)]: emission lines, or any other light
  source,    ///< samples of the source function [W/(m^2 sr)], emitted by the absorption
};

/// Weights of the intervals' nodes. The radiance at the ray's near end is the sum over intervals i
/// and nodes n of weights[i][n] * field at that node.
/// @param absorption samples [1/m]; empty: none
/// @param weights overwritten, one entry for each interval
/// @return transmittance of all intervals
double node_weights(std::span<const RayInterval> intervals, std::span<const double> absorption,
                    RowModel model, std::vector<std::array<double, 2>>& weights);

}  // namespace plenoflame
