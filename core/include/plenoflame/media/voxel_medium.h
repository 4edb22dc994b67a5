#pragma once
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "plenoflame/math/vector.h"
#include "plenoflame/media/medium.h"
#include "plenoflame/radiometry/source_function.h"

namespace plenoflame {

/// Affine map: world = linear * index + translation.
struct AffineTransform {
  Mat3 linear;
  Vec3 translation;
  constexpr Vec3 point(Vec3 p) const { return linear * p + translation; }
};

/// A scalar field on a sparse lattice in plain arrays, the form to which a VDB grid is converted.
/// Samples are at integer index coordinates. Bricks hold 8 x 8 x 8 samples: value (i, j, k) of
/// brick b is values[b * 512 + (i * 8 + j) * 8 + k]. Everywhere else the field is `background`.
struct VoxelField {
  std::vector<std::array<int, 3>> brick_origins;  ///< lowest index of each brick, multiples of 8
  std::vector<float> values;                      ///< 512 per brick
  float background = 0;
  AffineTransform index_to_world;
  std::string name;
};

enum class VoxelInterpolation {
  trilinear,  ///< between the samples around a point; values of temperature and absorption
  constant,   ///< each voxel (half a spacing to each side of its sample) has one value
};

/// Fields that a voxel medium may have besides temperature and absorption. Their samples are at the
/// places of the absorption's samples, shifted by whole spacings at most.
struct VoxelExtras {
  /// Light of emission lines [W/(m^3 sr)], whatever the temperature; background 0.
  std::vector<VoxelField> lines = {};
  /// The weight of line l in channel c, at [c * lines + l].
  std::vector<double> line_weights = {};
  /// Share of the extinction that is scattering, at least 0 and below 1. The medium's absorption()
  /// is then the extinction, absorption / (1 - albedo) at each sample, and its emission that of the
  /// absorption.
  std::optional<VoxelField> albedo = {};
};
inline constexpr std::size_t kMostVoxelLines = 8;

struct VoxelMediumOptions {
  /// Largest share of a brick's emission that the quadrature within one cell may miss. A cell with
  /// a steep source function is cut into as many intervals as this needs (32 at most). 0: always
  /// one interval per cell. If temperature has its own lattice, cells are cut at the faces of both
  /// lattices, and not further.
  double tolerance = 3e-4;
  std::vector<double> absorption_factors = {};  ///< per channel, on the grid's; empty: grey
  VoxelExtras extras = {};
  FlamePlacement placement = {};  ///< of the frame in which the fields' transforms are
};

/// Emission and absorption on voxel grids. Both fields may have different transforms. Absorption's
/// background must be 0. Integration is exact for `constant`, of fourth order in the cell size for
/// `trilinear` (docs/theory/emission.md), stable for any optical thickness.
/// @throws InputError for a background other than 0, a singular transform, NaN or negative values
///         (names field and index)
/// @throws InputError for a tolerance outside of [0, 1), extras on another lattice than the
///         absorption's, more than kMostVoxelLines
std::unique_ptr<Medium> make_voxel_medium(VoxelField temperature, VoxelField absorption,
                                          VoxelInterpolation interpolation,
                                          std::vector<SourceFunction> channels,
                                          const VoxelMediumOptions& options = {});

}  // namespace plenoflame
