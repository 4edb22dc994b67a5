#include "plenoflame/volumes/load_medium.h"

#include "plenoflame/volumes/flame_file.h"

namespace plenoflame {

std::shared_ptr<const Medium> load_medium(const FlameSpec& flame, const std::string& scene_folder,
                                          const std::vector<SourceFunction>& channels,
                                          const Execution& execution) {
  return flame.kind == FlameKind::vdb ? load_flame(flame, scene_folder, channels, execution)
                                      : load_core_medium(flame, scene_folder, channels, execution);
}

CompiledScene compile_scene(const SceneDocument& document, const Execution& execution,
                            const EarlierScenes& earlier, const std::vector<IssueCode>& unsaid) {
  return compile(document, load_medium, execution, earlier, unsaid);
}

}  // namespace plenoflame
