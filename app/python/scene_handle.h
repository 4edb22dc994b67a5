#pragma once
#include <string>
#include <utility>
#include <vector>

#include "plenoflame/volumes/scene_session.h"

namespace plenoflame::python {

/// A scene without VTK, in place of vtkPlenoflameScene.
struct SceneHandle : SceneSession {
  std::vector<std::string> warnings;  ///< not fetched yet
};

}  // namespace plenoflame::python
