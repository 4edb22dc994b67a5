#include "surfaces/mesh.h"

#include <fmt/format.h>

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <algorithm>
#include <assimp/Importer.hpp>
#include <cctype>
#include <cmath>

#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"

namespace plenoflame {
namespace {

Vec3 to_vector(const aiVector3D& v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

bool is_finite(Vec3 v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

std::string lower_extension(const std::string& path) {
  const auto dot = path.find_last_of("./");
  std::string extension = dot == std::string::npos || path[dot] == '/' ? "" : path.substr(dot + 1);
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

/// Adds what is a triangle of positive area. @return false when it has none
bool add_face(const aiMesh& mesh, const aiFace& face, std::uint32_t first, MeshData& data) {
  std::array<std::uint32_t, 3> corner{};
  for (unsigned k = 0; k < 3; ++k) corner[k] = first + face.mIndices[k];
  const Vec3 a = data.vertices[corner[0]], b = data.vertices[corner[1]],
             c = data.vertices[corner[2]];
  const Vec3 normal = cross(b - a, c - a);
  // Half the area squared underflows only where the area means nothing, too.
  if (!(dot(normal, normal) > 0)) return false;
  if (mesh.HasNormals()) {
    Vec3 given;
    for (unsigned k = 0; k < 3; ++k) given = given + to_vector(mesh.mNormals[face.mIndices[k]]);
    if (dot(given, normal) < 0) std::swap(corner[1], corner[2]);
  }
  data.triangles.push_back(corner);
  return true;
}

}  // namespace

MeshData read_mesh(const std::string& path, const std::string& what, const Execution& execution) {
  const std::string extension = lower_extension(path);
  if (extension != "obj" && extension != "ply" && extension != "stl")
    throw InputError(what + ": \"" + path + "\" is not an OBJ, PLY or STL file by its name");
  const std::string bytes = read_file(path);
  Assimp::Importer importer;
  // From memory, so that a file cannot make the importer open others.
  const aiScene* scene = importer.ReadFileFromMemory(bytes.data(), bytes.size(),
                                                     aiProcess_Triangulate, extension.c_str());
  const std::string where = what + ": the mesh file \"" + path + "\"";
  if (!scene) {
    std::string reason = importer.GetErrorString();
    std::replace(reason.begin(), reason.end(), '\n', ' ');
    throw InputError(where + " cannot be used: " + (reason.empty() ? "it is damaged" : reason));
  }
  MeshData data;
  std::size_t without_area = 0;
  bool textured = scene->mNumMeshes > 0;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m)
    textured = textured && scene->mMeshes[m]->HasTextureCoords(0);
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    const aiMesh& mesh = *scene->mMeshes[m];
    const auto first = static_cast<std::uint32_t>(data.vertices.size());
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      data.vertices.push_back(to_vector(mesh.mVertices[v]));
      if (!is_finite(data.vertices.back()))
        throw InputError(where + fmt::format(" has a vertex that is not finite: number {} of {}",
                                             data.vertices.size(), mesh.mNumVertices));
      if (textured)
        data.texture.push_back({static_cast<double>(mesh.mTextureCoords[0][v].x),
                                static_cast<double>(mesh.mTextureCoords[0][v].y)});
    }
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices != 3) continue;  // points and lines
      for (unsigned k = 0; k < 3; ++k)
        if (face.mIndices[k] >= mesh.mNumVertices)
          throw InputError(where +
                           fmt::format(": face {} names a vertex that does not exist", f + 1));
      if (!add_face(mesh, face, first, data)) ++without_area;
    }
  }
  if (data.triangles.empty())
    throw InputError(where + (without_area > 0 ? " has only faces without area" : " has no faces"));
  if (without_area > 0)
    execution.warn(where +
                   fmt::format(" has {} faces without area, which are left out", without_area));
  return data;
}

}  // namespace plenoflame
