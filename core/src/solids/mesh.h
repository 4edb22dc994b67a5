#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/math/vector.h"

namespace plenoflame {

/// Triangles of a file, in its own frame and unit.
struct MeshData {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counterclockwise seen from the front
  std::vector<Vec2> texture;  ///< per vertex; empty when the file has no texture coordinates
};

/// Reads an OBJ, PLY or STL file. Faces of more corners are cut into triangles; where the file has
/// normals they decide which side of a face is its front. Faces without area are left out, with a
/// warning.
/// @param what the surface is called in messages
/// @throws FileError when the file cannot be read, InputError when it is damaged, has a vertex that
///         is not finite, or no face
MeshData read_mesh(const std::string& path, const std::string& what, const Execution& execution);

}  // namespace plenoflame
