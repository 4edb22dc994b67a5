#pragma once
#include <string>

#include "plenoflame/scene/scene.h"

namespace plenoflame {

/// The folder from which relative paths of the scene start; empty: the working directory.
inline std::string folder_of(const Scene& scene) {
  const auto slash = scene.file.find_last_of('/');
  return slash == std::string::npos ? "" : scene.file.substr(0, slash);
}

}  // namespace plenoflame
