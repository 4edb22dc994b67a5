#pragma once
#include <string>
#include <vector>

#include "plenoflame/scene/scene.h"

namespace plenoflame {

/// A key in which two scenes differ.
struct SceneDifference {
  std::string path;           ///< "camera.lens.surfaces[0].radius", as in messages about scenes
  std::string before, after;  ///< as write_scene() puts them; empty: the scene has no such key
};

/// All of them, in the order of write_scene(). @throws InputError as write_scene()
std::vector<SceneDifference> scene_differences(const Scene& before, const Scene& after);

}  // namespace plenoflame
