#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "plenoflame/scene/scene.h"

namespace plenoflame {

/// A file that a scene names, with the data that reveal a change.
struct InputFile {
  std::string name;           ///< as in the scene
  std::uintmax_t size = 0;    ///< [byte]; 0: there is none
  std::int64_t modified = 0;  ///< time of the last change, in the file system's own count
  friend bool operator==(const InputFile&, const InputFile&) = default;
};

/// @param folder that a relative name starts in
InputFile input_file(const std::string& name, const std::string& folder);

/// All files that compiling a scene reads: flames, meshes, textures and curves, in its order.
std::vector<InputFile> input_files(const Scene& scene);

}  // namespace plenoflame
