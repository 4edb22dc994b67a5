#pragma once
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/media/medium.h"
#include "plenoflame/media/voxel_medium.h"
#include "plenoflame/radiometry/source_function.h"
#include "plenoflame/scene/scene.h"

/// Flames from .vdb files: the two grids of a flame, in SI units, checked.
namespace plenoflame {

struct FlameFields {
  VoxelField temperature;  ///< [K]
  VoxelField absorption;   ///< [1/m], background 0
};

/// Grid names that are tried, in this order and without regard to case, when a scene names none.
std::span<const std::string_view> temperature_grid_names();
std::span<const std::string_view> absorption_grid_names();

/// Reads the grids of a flame of kind vdb: value = scale * stored + offset, in the unit that the
/// scene or else the file's metadata states (else K and 1/m), converted to K and 1/m.
/// Temperature: K, degC. Absorption: 1/m, 1/cm, 1/mm. The transforms are the file's; the flame's
/// scale, position and rotation are not applied.
/// @param scene_folder relative paths start here; empty: the current folder
/// @param execution gets a warning when the largest temperature is below 200 K
/// @throws FileError (see read_voxel_field). @throws InputError: a grid is missing (lists those
/// present), an unknown unit, NaN or infinite or negative values (names grid and voxel),
/// absorption with a background other than 0.
FlameFields read_flame(const FlameSpec& spec, const std::string& scene_folder,
                       const Execution& execution);

/// The flame as a medium, scaled, turned and placed as the flame says: the MediumLoader for flames
/// of kind vdb. @throws as read_flame; InputError when scale is not a positive number.
std::unique_ptr<Medium> load_flame(const FlameSpec& spec, const std::string& scene_folder,
                                   std::vector<SourceFunction> channels,
                                   const Execution& execution);

}  // namespace plenoflame
