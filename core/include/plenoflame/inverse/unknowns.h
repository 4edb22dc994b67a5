#pragma once
#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "plenoflame/media/lattice_walk.h"

/// The unknowns of a reconstruction: a field as a sum of samples times basis functions.
namespace plenoflame {

class Unknowns {
 public:
  virtual ~Unknowns() = default;
  virtual std::size_t size() const = 0;
  /// Samples along each of up to three axes, last axis fastest in the numbering; 1 where there is
  /// no axis.
  virtual std::array<int, 3> shape() const = 0;
  /// Distance of samples along each of these axes [m].
  virtual std::array<double, 3> spacing() const = 0;
  /// True if the first axis begins at a centre, on both sides of which the field is the same.
  virtual bool begins_at_centre() const { return false; }
  /// True if the field is linear between samples.
  virtual bool is_linear() const { return true; }
  /// World box outside of which every basis function is 0.
  virtual Box bounds() const = 0;
  /// World place of an unknown (for a ring, one of its points).
  virtual Vec3 place(std::size_t unknown) const = 0;
  /// Volume that an unknown fills [m^3], the integral of its basis function.
  virtual double volume(std::size_t unknown) const = 0;
  /// Unknowns at half the spacing: each axis has one more between two, and one beyond an end at
  /// which the field falls to 0. An axis of one unknown stays.
  virtual std::unique_ptr<Unknowns> refined() const = 0;
  /// Appends the intervals of a ray between two places, in their order along it.
  virtual void append(const Ray& ray, double t_near, double t_far, RayIntervals& out) const = 0;
  /// Values as a field on a lattice of voxels, 0 outside. @param background of the field
  virtual VoxelField field(std::span<const double> values, const std::string& name) const = 0;
};

/// Values at the places of the unknowns of a smooth field, whose samples are the best fit by linear
/// interpolation. Straight lines cut corners. In least squares, samples therefore differ from the
/// field by a twelfth of the second difference, which is corrected along each axis. Sums are
/// unchanged.
/// @param solved 0: the unknown is and stays empty; empty: none is
std::vector<double> values_at_places(const Unknowns& unknowns, std::span<const double> samples,
                                     const std::vector<char>& solved);
/// The samples whose values_at_places() these are, but not below 0. Values of 0 are and stay empty.
std::vector<double> samples_of_places(const Unknowns& unknowns, std::span<const double> values);
/// A smooth field that has `values` at the places, at those of refined() unknowns: by cubic
/// interpolation, but not below 0.
std::vector<double> refined_values(const Unknowns& unknowns, std::span<const double> values);
/// The mean of each value and its neighbours along the axes, which have half of its weight.
std::vector<double> averaged_with_neighbours(const Unknowns& unknowns, std::vector<double> values);
/// How far a field may lie from its interpolation between unknowns: an eighth of the second
/// differences, the height of an arc over its chord. The root of the mean square of a place and its
/// neighbours, summed over the axes. Beyond the lattice the field is 0.
/// @param absorption [1/m] if the field is a source function: the differences are those of the
/// light
std::vector<double> errors_of_chords(const Unknowns& unknowns, std::span<const double> values,
                                     std::span<const double> absorption = {});

/// Voxels of a regular lattice.
/// @throws InputError for a singular transform or an axis without samples
std::unique_ptr<Unknowns> make_voxel_unknowns(const RegularLattice& lattice);

/// Rings around an axis: samples at radius i * radial_step (0 <= i < rings) and at height j *
/// height_step above the base (0 <= j < heights). Linear in between, 0 outside; unknown (i, j) has
/// the number i * heights + j.
struct RingGrid {
  Vec3 base;                                ///< [m] world; the point of the axis at height 0
  Vec3 axis{0, 0, 1};                       ///< unit vector, upwards
  double radial_step = 0, height_step = 0;  ///< [m]
  int rings = 0, heights = 0;
};
/// @throws InputError for steps that are not above 0, no rings, or an axis without direction
std::unique_ptr<Unknowns> make_ring_unknowns(const RingGrid& grid);

/// Ellipsoidal layers: samples on ellipsoids of i / layers times the semi-axes (0 <= i < layers),
/// linear in between, 0 on the outermost one and beyond.
struct LayerGrid {
  Vec3 centre;     ///< [m] world
  Vec3 semi_axes;  ///< [m] of the outermost ellipsoid, along the world's axes
  int layers = 0;
};
/// @throws InputError for semi-axes that are not above 0, or no layers
std::unique_ptr<Unknowns> make_layer_unknowns(const LayerGrid& grid);

}  // namespace plenoflame
