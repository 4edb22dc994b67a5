#pragma once
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/math/vector.h"
#include "plenoflame/volumes/flame_file.h"

namespace plenoflame::detail {

/// A flame as functions of the place of a voxel's sample [m]. Called from many threads.
struct FlameFunctions {
  std::function<double(Vec3)> absorption;   ///< [1/m] >= 0, and 0 outside of the bounds
  std::function<double(Vec3)> temperature;  ///< [K] > 0 everywhere
  /// Emission lines: the grid's name, and [W/m^3] >= 0, 0 outside of the bounds.
  std::vector<std::pair<std::string, std::function<double(Vec3)>>> lines = {};
};

/// Samples the functions on one lattice of cubic voxels (sample (0, 0, 0) at the origin).
/// Absorption and lines are stored where they are not 0, temperature in every brick within two
/// voxels of such a sample.
/// @throws InputError for a voxel size that is not positive, gives too many voxels, or exceeds half
///         of the flame's least extent; Cancelled
FlameFields sample_flame(const FlameFunctions& flame, const Box& bounds, double voxel_size,
                         const Execution& execution);

/// @throws InputError "NAME must be ..." unless low < value < high (NaN fails).
void require_between(const char* name, double value, double low, double high);

}  // namespace plenoflame::detail
