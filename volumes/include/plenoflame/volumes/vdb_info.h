#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "plenoflame/volumes/grid_file.h"

namespace plenoflame {

/// The report of `plenoflame info FILE.vdb`.
struct VdbInfo {
  std::string file;
  std::uint64_t file_size = 0;  ///< [byte]
  std::vector<GridInfo> grids;
  /// Names of the grids that a scene which names none would take; empty: there is none.
  std::string temperature_grid;
  std::string absorption_grid;
  /// Grids with a name of an emission line, and the scene's word for its kind.
  struct Line {
    std::string grid, kind;
  };
  std::vector<Line> lines;
  bool emission_alone = false;  ///< a reconstruction without absorption, so without temperatures
  /// Remarks for the user: missing grids, units that are not stated, suspicious ranges; one
  /// sentence each.
  std::vector<std::string> remarks;
};

/// @throws FileError as list_grids.
VdbInfo vdb_info(const std::string& path);

}  // namespace plenoflame
