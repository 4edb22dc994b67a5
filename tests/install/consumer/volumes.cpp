// Uses the installed library of flames: OpenVDB is linked through the package, its headers are not
// needed.
#include <cstdio>
#include <string>
#include <vector>

#include "plenoflame/base/error.h"
#include "plenoflame/base/version.h"
#include "plenoflame/volumes/grid_file.h"
#include "plenoflame/volumes/grid_writer.h"

namespace {

bool files_work(const std::string& path) {
  plenoflame::VoxelField field;
  field.name = "temperature";
  field.background = 300;
  const std::vector<plenoflame::GridOutput> grids{{&field, "K"}};
  plenoflame::write_grids(path, grids);
  const std::vector<plenoflame::GridInfo> info = plenoflame::list_grids(path);
  return info.size() == 1 && info[0].name == "temperature" && info[0].unit == "K" &&
         info[0].background == 300;
}

bool errors_arrive(const std::string& path) {
  try {
    plenoflame::list_grids(path);
  } catch (const plenoflame::FileError&) {
    return true;
  }
  return false;
}

}  // namespace

int main(int count, char** arguments) {
  const std::string folder = count > 1 ? arguments[1] : ".";
  std::printf("plenoflame %s\n", std::string(plenoflame::version()).c_str());
  if (!files_work(folder + "/flame.vdb")) return 1;
  if (!errors_arrive(folder + "/nowhere.vdb")) return 2;
  return 0;
}
