#pragma once
#include <cstdint>
#include <map>
#include <span>
#include <stop_token>
#include <string>

#include "plenoflame/media/voxel_medium.h"

namespace plenoflame {

enum class VdbCompression {
  none,   ///< only runs of the background are left out
  zip,    ///< smallest, slow to write
  blosc,  ///< nearly as small, fast
};

struct GridWriteOptions {
  bool half =
      false;  ///< store values with 16 bits (relative error 2^-11; float grids as before in memory)
  VdbCompression compression = VdbCompression::blosc;
  std::map<std::string, std::string> metadata;  ///< of the file, e.g. {"creator", "plenoflame 0.1"}
  std::stop_token stop;                         ///< looked at from brick to brick
};

/// One grid to be written: its name, background, values and transform are the field's.
struct GridOutput {
  const VoxelField* field = nullptr;
  std::string unit;                                  ///< metadata "unit", e.g. "K"
  std::map<std::string, std::string> metadata = {};  ///< of the grid, beside its unit
};

/// Writes float grids of class "fog volume" to a .vdb file under a temporary name that is renamed
/// at the end. An existing file is replaced as a whole or left alone. Voxels that have the
/// background's value are inactive, all others active.
/// @return size of the file [byte]
/// @throws FileError naming the file and the cause (folder missing, not writable, disk full).
/// @throws InputError for a singular transform, or values that 16 bits cannot hold (above 65504).
/// @throws Cancelled when a stop is requested, as if nothing had been begun.
std::uint64_t write_grids(const std::string& path, std::span<const GridOutput> grids,
                          const GridWriteOptions& options = {});

}  // namespace plenoflame
