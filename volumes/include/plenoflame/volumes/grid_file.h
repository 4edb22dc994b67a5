#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "plenoflame/math/vector.h"
#include "plenoflame/media/voxel_medium.h"

/// Grids of OpenVDB files as plain values. Nothing here needs OpenVDB's headers.
namespace plenoflame {

/// One grid of a .vdb file.
struct GridInfo {
  std::string name;        ///< as stored; several grids of a file may share it
  std::string value_type;  ///< "float", "double", "vec3s", "points", ...
  bool readable = false;   ///< read_voxel_field can read it: float or double, not a frustum
  bool half = false;       ///< values are stored with 16 bits
  std::string unit;        ///< metadata "unit", else "units"; empty: none
  std::string grid_class;  ///< "fog volume", "level set", ...; empty: not stated
  std::map<std::string, std::string> metadata;  ///< everything else that the file says, as text

  std::string transform_type;      ///< OpenVDB's name, e.g. "ScaleTranslateMap"
  AffineTransform index_to_world;  ///< [m]; meaningless for a frustum
  double voxel_size = 0;           ///< [m] smallest spacing along an axis

  double background = 0;            ///< value where nothing is stored
  std::uint64_t active_voxels = 0;  ///< voxels of active tiles included
  double minimum = 0;               ///< over active voxels; 0 when there are none
  double maximum = 0;
  /// Lowest and highest index of active voxels; lowest > highest when there are none.
  std::array<int, 3> index_lower{1, 1, 1};
  std::array<int, 3> index_upper{0, 0, 0};
  Box world_bounds;  ///< [m] box around the active voxels' sample points; empty when there are none
};

/// The grids of a .vdb file. Statistics of grids that are not float or double come from the file's
/// own metadata, if present.
/// @throws FileError naming the file: cannot be opened, is not a .vdb, is truncated or damaged
/// @param statistics false leaves out all that needs the voxels: background to world_bounds
std::vector<GridInfo> list_grids(const std::string& path, bool statistics = true);

/// Largest number of 8^3 bricks that one grid may become (4 GiB of values).
inline constexpr std::size_t kMaxBricks = std::size_t{1} << 21;

/// Reads a float or double grid (stored with 16, 32 or 64 bits; kept as float).
///
/// Voxels count by their value, whether active or not. Active tiles become bricks; so do inactive
/// voxels and tiles whose value differs from the background's. Bricks with nothing but the
/// background are left out. Every affine transform is kept as it is, rotation and shear included.
/// @param name of the grid, or "name[1]" for the second of several with the same name
/// @throws FileError as list_grids.
/// @throws InputError, naming file and grid: no such grid (lists those present), another type, a
///         frustum or singular transform, more than kMaxBricks
VoxelField read_voxel_field(const std::string& path, const std::string& name);

}  // namespace plenoflame
