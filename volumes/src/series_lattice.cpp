#include "plenoflame/volumes/series_lattice.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "plenoflame/base/error.h"
#include "plenoflame/base/units.h"

namespace plenoflame {
namespace {

/// Programs write transforms in single precision, too.
constexpr double kSame = 1e-5;

/// The difference between two lattices in words; empty: nothing that is more than rounding of a
/// voxel's size.
std::string difference(const GridInfo& first, const GridInfo& second) {
  const AffineTransform &a = first.index_to_world, &b = second.index_to_world;
  for (std::size_t row = 0; row < 3; ++row)
    if (length(a.linear.rows[row] - b.linear.rows[row]) > kSame * first.voxel_size)
      return fmt::format("voxels of {} (or turned otherwise) instead of {}",
                         readable_quantity(second.voxel_size, Dimension::length, 6),
                         readable_quantity(first.voxel_size, Dimension::length, 6));
  const double moved = length(a.translation - b.translation);
  // Far from the origin single precision moves a lattice by more.
  const double size = first.voxel_size + length(a.translation) * 1e-2;
  if (moved > kSame * size)
    return fmt::format("its lattice displaced by {}",
                       readable_quantity(moved, Dimension::length, 6));
  return {};
}

}  // namespace

void SeriesLattice::check(std::size_t flame, const FlameSpec& spec,
                          const std::string& scene_folder) {
  const std::string path = (std::filesystem::path(scene_folder) / spec.file).string();
  const auto first = firsts_.find(flame);
  if (first != firsts_.end() && first->second.file == spec.file) return;
  std::vector<GridInfo> grids = list_grids(path, false);
  if (first == firsts_.end()) {
    firsts_[flame] = {spec.file, std::move(grids)};
    return;
  }
  for (const GridInfo& grid : grids)
    for (const GridInfo& other : first->second.grids) {
      if (grid.name != other.name) continue;
      const std::string what = difference(other, grid);
      if (!what.empty())
        throw InputError(
            fmt::format("the grid \"{}\" of '{}' has {}, unlike '{}'; all files of a series need "
                        "one lattice: resample them, or render them from scenes of their own",
                        grid.name, path, what, first->second.file));
    }
}

}  // namespace plenoflame
