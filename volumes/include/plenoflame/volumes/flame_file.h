#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/media/medium.h"
#include "plenoflame/media/voxel_medium.h"
#include "plenoflame/radiometry/source_function.h"
#include "plenoflame/scene/flame_spec.h"
#include "plenoflame/volumes/grid_writer.h"

/// Flames from .vdb files: the two grids of a flame, in SI units, checked.
namespace plenoflame {

struct FlameFields {
  VoxelField temperature;  ///< [K]
  VoxelField absorption;   ///< [1/m], background 0
  /// Light of each emission line of the flame [W/m^3] into all directions, background 0.
  std::vector<VoxelField> lines = {};
  std::optional<VoxelField> albedo = {};  ///< at least 0 and below 1
};

/// Grid names that are tried, in this order and without regard to case, when a scene names none.
std::span<const std::string_view> temperature_grid_names();
std::span<const std::string_view> absorption_grid_names();
/// Names of an emission line's grid; none for a custom line.
std::span<const std::string_view> line_grid_names(LineKind line);

/// A line whose grid is known by its name; of a radical's lines the strongest stands for all.
struct LineGrid {
  LineKind kind;
  std::string_view name;  ///< the one that is written; those of line_grid_names() are read
};
std::span<const LineGrid> line_grids();

/// Reads the grids of a flame of kind vdb: value = scale * stored + offset, converted to K and 1/m.
/// The unit comes from the scene, else from the file's metadata, else it is K or 1/m. Temperature:
/// K, degC. Absorption: 1/m, 1/cm, 1/mm. Emission lines need a unit of emission_unit(). The
/// transforms are the file's; the flame's scale, position and rotation are not applied.
///
/// A flame with emission lines needs no grid of absorption, unless the scene names or maps one, or
/// a temperature, or sets scattering. Without absorption it needs no temperature either.
/// @param scene_folder relative paths start here; empty: the current folder
/// @param execution gets a warning when the largest temperature is below 200 K or nothing is
///        visible. Also when a flame of emission lines alone leaves other grids unused
/// @throws FileError (see read_voxel_field)
/// @throws InputError: a grid is missing (lists those present), an unknown unit, values that are
///         NaN, infinite or negative (names grid and voxel)
/// @throws InputError: absorption or emission with a background other than 0, emission without a
///         unit
FlameFields read_flame(const FlameSpec& spec, const std::string& scene_folder,
                       const Execution& execution);

/// The grids of a file for scripts: temperature and absorption by these names, as read_flame()
/// returns them. From a file with neither of them (a reconstruction's emission) all readable grids,
/// by their own names and as stored.
/// @param path of the file @throws as read_flame
std::vector<VoxelField> read_flame_grids(const std::string& path, const Execution& execution);

/// Writes all grids of a flame with their units, and who wrote them.
/// @return size of the file [byte] @throws as write_grids
std::uint64_t write_flame(const std::string& path, const FlameFields& flame,
                          GridWriteOptions options = {});

/// Grids that are there already as a medium: scaled, turned and placed as the flame says.
/// @throws InputError when scale is not a positive number
std::unique_ptr<Medium> make_flame_medium(FlameFields flame, const FlameSpec& spec,
                                          std::vector<SourceFunction> channels);

/// The flame as a medium, scaled, turned and placed as the flame says: the MediumLoader for flames
/// of kind vdb. @throws as read_flame; InputError when scale is not a positive number.
std::unique_ptr<Medium> load_flame(const FlameSpec& spec, const std::string& scene_folder,
                                   std::vector<SourceFunction> channels,
                                   const Execution& execution);

}  // namespace plenoflame
