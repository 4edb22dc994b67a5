#pragma once
#include <array>
#include <string>
#include <vector>

#include "media/field_reader.h"
#include "media/voxels/voxel_kernel.h"
#include "media/voxels/voxel_steps.h"
#include "plenoflame/media/voxel_medium.h"

namespace plenoflame::voxel {

/// A further field on the samples of another one: its sample i + shift belongs to sample i of that.
struct ExtraField {
  const FieldReader* field;  ///< nullptr: there is none
  Index shift;
  bool emits;  ///< cells where it is not 0 are not empty
};

/// One or more fields on the same samples as bricks of 8 x 8 x 8 cells with an apron, ready for the
/// kernel. Index coordinates are those of the field, shifted by half a spacing when every voxel has
/// one value. A cell then always reaches from one integer coordinate to the next.
class Lattice {
 public:
  /// Cells where `absorption`, or one of the extra fields, is not 0. Without a temperature field
  /// only absorption is stored.
  static Lattice of_absorption(const FieldReader& absorption, const ExtraField& temperature,
                               const std::vector<ExtraField>& extras,
                               VoxelInterpolation interpolation, const StepPlanner& steps,
                               const FlamePlacement& placement);
  /// Cells where `temperature` differs from its background.
  static Lattice of_temperature(const FieldReader& temperature, VoxelInterpolation interpolation,
                                const FlamePlacement& placement);
  /// A copy that lies elsewhere: nothing that is stored depends on the place or the scale.
  Lattice placed(const FlamePlacement& placement) const;

  /// (temperature, absorption) at an index coordinate; the background outside of stored bricks.
  std::array<double, 2> sample(Vec3 index) const;
  /// sample() at several index coordinates of one cell, which is looked up once.
  /// @param temperature, absorption `count` values each; nullptr: skipped
  void sample_cell(const Vec3* index, int count, double* temperature, double* absorption) const;
  /// Weighted sum of the extra fields at an index coordinate: weights[e] * field e.
  double sum_extras(Vec3 index, const double* weights) const;
  /// Tells whether the brick around an index coordinate is stored.
  bool occupied(Vec3 index) const;
  /// The kernel's view of the lattice. Valid as long as this lattice is.
  LatticeView view() const;

  const AffineTransform& index_to_world() const { return index_to_world_; }
  const AffineTransform& world_to_index() const { return world_to_index_; }
  bool empty() const { return table_.empty(); }
  /// Index of the first cell of the table: where the view's coordinates count from.
  Vec3 origin() const;
  /// Tight box around the cells that are not background, index coordinates.
  Vec3 lower() const { return lower_; }
  Vec3 upper() const { return upper_; }
  /// Smallest distance between neighbouring planes of samples [m].
  double spacing() const;

  std::size_t varying_bricks() const { return varying_; }
  std::size_t constant_bricks() const { return constants_.size(); }
  /// Temperature and absorption of each constant brick.
  struct Constant {
    float temperature, absorption;
    int data;  ///< its brick in the values, shared by equal ones
  };
  /// Extra field e of a constant brick.
  float constant_extra(const Constant& constant, int e) const {
    return extras_[static_cast<std::size_t>(constant.data * extra_fields_ + e) * kBrickPairs];
  }
  const std::vector<Constant>& constants() const { return constants_; }
  std::size_t bytes() const;
  /// [1/m] of any sample.
  double largest_absorption() const { return most_; }
  /// [1/m] Absorption is nowhere above this between two index coordinates.
  double largest_absorption(Vec3 lower, Vec3 upper) const;
  /// Lowest and highest stored temperature [K].
  std::array<float, 2> temperature_range() const { return temperature_range_; }

 private:
  Lattice(const FieldReader& primary, VoxelInterpolation interpolation,
          const FlamePlacement& placement);
  void set_placement(const FlamePlacement& placement);
  void store(const std::vector<Index>& bricks, const FieldReader* absorption,
             const FieldReader* temperature, Index temperature_shift,
             const std::vector<ExtraField>& extras, const StepPlanner* steps);
  /// Samples around a place, with their weights: pair (value index) and brick of the values.
  struct Corners {
    int brick = -1;  ///< of the values; -1: background
    int count = 0;
    std::array<int, 8> sample{};
    std::array<double, 8> weight{};
  };
  Corners corners(Vec3 index) const;
  int entry(Index brick) const;

  AffineTransform index_to_flame_;  ///< of the samples, in the flame's own frame
  std::string field_;               ///< its name, for messages
  AffineTransform index_to_world_, world_to_index_;
  bool one_value_per_cell_ = false;
  float background_temperature_ = 0;
  Vec3 lower_, upper_;
  Index origin_{};          // lowest brick
  Index bricks_{};          // number of bricks along each axis
  Index blocks_{};          // number of blocks of 8 x 8 x 8 bricks
  std::vector<int> top_;    // first entry of a block in table_, -1: empty
  std::vector<int> table_;  // entries of bricks, see LatticeView
  std::vector<float> values_;
  std::vector<float> extras_;
  int extra_fields_ = 0;
  std::vector<int> steps_;  // kStepWords for each brick of the values
  std::vector<int> plain_;
  std::vector<float> most_of_brick_;  // largest absorption of each brick of the values [1/m]
  double most_ = 0;                   // of all
  int blank_ = 0;                     // brick of the values without absorption
  std::size_t varying_ = 0;
  std::vector<Constant> constants_;
  std::vector<int> constant_data_;  // the same bricks' data, for the kernel
  std::array<float, 2> temperature_range_{0, 0};
};

}  // namespace plenoflame::voxel
