#pragma once
#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "plenoflame/scene/flame_spec.h"
#include "plenoflame/volumes/grid_file.h"

namespace plenoflame {

/// Looks whether the files of a series have one lattice: grids of the same name the same voxels in
/// the same places. Which voxels are stored may differ.
class SeriesLattice {
 public:
  /// Compares a flame's file with the first one that was given for that flame.
  /// @param flame which of a scene's @param scene_folder as of load_flame()
  /// @throws InputError naming both files and what differs; FileError
  void check(std::size_t flame, const FlameSpec& spec, const std::string& scene_folder);

 private:
  struct First {
    std::string file;
    std::vector<GridInfo> grids;
  };
  std::map<std::size_t, First> firsts_;
};

}  // namespace plenoflame
