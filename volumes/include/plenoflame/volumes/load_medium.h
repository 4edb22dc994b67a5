#pragma once
#include <memory>
#include <string>
#include <vector>

#include "plenoflame/scene/compile.h"

namespace plenoflame {

/// Makes the medium of a flame of any kind, in closed form or from an OpenVDB file. It is the
/// MediumLoader of every program that is built with volumes.
/// @throws InputError, FileError
std::shared_ptr<const Medium> load_medium(const FlameSpec& flame, const std::string& scene_folder,
                                          const std::vector<SourceFunction>& channels,
                                          const Execution& execution);

/// compile() of a document with this loader: flames of any kind.
CompiledScene compile_scene(const SceneDocument& document, const Execution& execution = {},
                            const EarlierScenes& earlier = {},
                            const std::vector<IssueCode>& unsaid = {});

}  // namespace plenoflame
