#include "plenoflame/image/atomic_file.h"
#include "plenoflame/scene/scene_file.h"
#include "plenoflame/volumes/flame_library.h"

namespace plenoflame {

std::vector<EllipsoidSpec> read_layers(const std::string& path) {
  return parse_layers(read_file(path), path);
}

}  // namespace plenoflame
