#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/math/vector.h"
#include "plenoflame/scene/solid_spec.h"

namespace plenoflame {

/// Triangles that show a surface. For pictures: nothing that is computed of a scene uses them, its
/// shapes are exact.
struct SurfaceMesh {
  std::vector<Vec3> vertices;                           ///< [m] world
  std::vector<Vec3> normals;                            ///< per vertex, unit, towards the front
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counterclockwise seen from the front
  std::vector<float> reflectivity;  ///< per triangle, at its middle; 0 where it only emits
};

struct SurfaceMeshSettings {
  int around = 64;     ///< pieces of a circle
  int across = 120;    ///< pieces along a side that has a texture
  double endless = 2;  ///< [m] side of the square that represents an infinite plane
  Vec3 endless_near;   ///< [m] world; its middle is the point of the plane nearest to this one
};

/// Vertices lie on the surface, those of a mesh file are the file's. Edges are sharp: vertices are
/// not shared between faces.
/// @param folder of the scene file, for meshes and textures
/// @throws InputError (also when this build has no surfaces), FileError
SurfaceMesh surface_mesh(const SolidSurfaceSpec& spec, const std::string& folder,
                         const SurfaceMeshSettings& settings = {}, const Execution& execution = {});

}  // namespace plenoflame
