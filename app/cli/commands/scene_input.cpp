#include "commands/scene_input.h"

#include "plenoflame/scene/validate.h"

namespace plenoflame::cli {

SceneDocument read_valid_scene(const std::string& path, std::vector<std::string>* warnings) {
  SceneDocument document = read_scene_file(path);
  try {
    for (const SceneIssue& issue : validate(document))
      if (warnings) warnings->push_back(to_string(issue));
  } catch (const InputError& error) {
    // About a key that stands nowhere in the file: say at least which file.
    if (error.position().file.empty()) throw InputError(SourcePosition{path}, error.what());
    throw;
  }
  return document;
}

}  // namespace plenoflame::cli
