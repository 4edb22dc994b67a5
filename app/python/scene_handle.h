#pragma once
#include <string>
#include <utility>
#include <vector>

#include "plenoflame/volumes/scene_session.h"

namespace plenoflame::python {

/// What stands for vtkPlenoflameScene where there is no VTK.
struct SceneHandle : SceneSession {
  std::vector<std::string> warnings;  ///< not fetched yet
};

}  // namespace plenoflame::python
