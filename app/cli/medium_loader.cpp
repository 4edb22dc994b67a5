#include "medium_loader.h"

#ifdef PLENOFLAME_HAS_VOLUMES
#include "plenoflame/volumes/flame_file.h"
#endif

namespace plenoflame::cli {

MediumLoader medium_loader() {
#ifdef PLENOFLAME_HAS_VOLUMES
  return [](const FlameSpec& flame, const std::string& scene_folder,
            const std::vector<SourceFunction>& channels, const Execution& execution) {
    return flame.kind == FlameKind::vdb
               ? load_flame(flame, scene_folder, channels, execution)
               : load_core_medium(flame, scene_folder, channels, execution);
  };
#else
  return load_core_medium;
#endif
}

}  // namespace plenoflame::cli
