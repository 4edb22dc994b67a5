#pragma once
#include <string>
#include <utility>
#include <vector>

#include "plenoflame/volumes/scene_session.h"

namespace plenoflame::python {

/// A scene, and what was said about it.
struct SceneHandle : SceneSession {
  std::vector<std::string> warnings;  ///< not fetched yet
};

}  // namespace plenoflame::python
