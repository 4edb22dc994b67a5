#include "plenoflame/base/version.h"
#include "plenoflame/volumes/flame_file.h"
#include "plenoflame/volumes/grid_writer.h"

namespace plenoflame {

std::uint64_t write_flame(const std::string& path, const FlameFields& flame,
                          GridWriteOptions options) {
  std::vector<GridOutput> grids{{&flame.temperature, "K"}, {&flame.absorption, "1/m"}};
  for (const VoxelField& line : flame.lines) grids.push_back({&line, "W/m^3"});
  if (flame.albedo) grids.push_back({&*flame.albedo, ""});
  options.metadata.try_emplace("creator", "plenoflame " + std::string(version()));
  return write_grids(path, grids, options);
}

}  // namespace plenoflame
