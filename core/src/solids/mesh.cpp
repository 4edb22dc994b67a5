#include "solids/mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>

#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"
#include "solids/mesh_files.h"
#include "solids/polygon.h"

namespace plenoflame {
namespace {

constexpr std::uintmax_t kMostBytes = std::uintmax_t{4} << 30;  ///< of a file
constexpr std::size_t kMostTriangles = std::size_t{1} << 27;    ///< Embree takes some 100 B of each

bool is_finite(Vec3 v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

std::string lower_extension(const std::string& path) {
  const auto dot = path.find_last_of("./");
  std::string extension = dot == std::string::npos || path[dot] == '/' ? "" : path.substr(dot + 1);
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

/// Text of a file must not steer the terminal.
std::string printable(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  return text;
}

/// Makes triangles of what a file says.
class Triangles {
 public:
  Triangles(MeshFile file, std::string where) : file_(std::move(file)), where_(std::move(where)) {
    for (std::size_t i = 0; i < file_.vertices.size(); ++i)
      if (!is_finite(file_.vertices[i]))
        throw InputError(where_ + fmt::format(" has a vertex that is not finite: number {} of {}",
                                              i + 1, file_.vertices.size()));
    textured_ = !file_.corners.empty() &&
                std::all_of(file_.corners.begin(), file_.corners.end(),
                            [](const MeshFile::Corner& c) { return c.texture >= 0; });
    // A vertex has one place on the texture, and may have several in the file.
    if (!textured_) data_.vertices = file_.vertices;
  }

  MeshData make() {
    const MeshFile::Corner* corners = file_.corners.data();
    for (const std::uint32_t count : file_.corner_counts) {
      if (count > kMostCorners)
        throw InputError(where_ + fmt::format(" has a face of {} corners; {} are possible", count,
                                              kMostCorners));
      if (count >= 3) add_face(corners, count);  // fewer are points and lines
      corners += count;
      if (data_.triangles.size() > kMostTriangles)
        throw InputError(where_ + fmt::format(" has more than {} triangles", kMostTriangles));
    }
    return std::move(data_);
  }
  std::size_t without_area() const { return without_area_; }

 private:
  void add_face(const MeshFile::Corner* corners, std::uint32_t count) {
    polygon_.clear();
    for (std::uint32_t k = 0; k < count; ++k)
      polygon_.push_back(file_.vertices[static_cast<std::size_t>(corners[k].vertex)]);
    cut_polygon(polygon_, pieces_);
    for (const std::array<std::uint32_t, 3>& piece : pieces_)
      add_triangle({&corners[piece[0]], &corners[piece[1]], &corners[piece[2]]});
  }

  void add_triangle(std::array<const MeshFile::Corner*, 3> corner) {
    const auto place = [this](const MeshFile::Corner* c) {
      return file_.vertices[static_cast<std::size_t>(c->vertex)];
    };
    const Vec3 a = place(corner[0]), b = place(corner[1]), c = place(corner[2]);
    const Vec3 normal = cross(b - a, c - a);
    // Half the area squared underflows only where the area means nothing, too.
    if (!(dot(normal, normal) > 0)) {
      ++without_area_;
      return;
    }
    Vec3 given;
    for (const MeshFile::Corner* c_k : corner)
      if (c_k->normal >= 0) given = given + file_.normals[static_cast<std::size_t>(c_k->normal)];
    if (dot(given, normal) < 0) std::swap(corner[1], corner[2]);
    std::array<std::uint32_t, 3> triangle{};
    for (std::size_t k = 0; k < 3; ++k) triangle[k] = vertex_of(*corner[k]);
    data_.triangles.push_back(triangle);
  }

  std::uint32_t vertex_of(const MeshFile::Corner& corner) {
    if (!textured_) return static_cast<std::uint32_t>(corner.vertex);
    data_.vertices.push_back(file_.vertices[static_cast<std::size_t>(corner.vertex)]);
    data_.texture.push_back(file_.texture[static_cast<std::size_t>(corner.texture)]);
    return static_cast<std::uint32_t>(data_.vertices.size() - 1);
  }

  MeshFile file_;
  std::string where_;
  MeshData data_;
  bool textured_ = false;
  std::size_t without_area_ = 0;
  std::vector<Vec3> polygon_;
  std::vector<std::array<std::uint32_t, 3>> pieces_;
};

}  // namespace

MeshData read_mesh(const std::string& path, const std::string& what, const Execution& execution) {
  const std::string extension = lower_extension(path);
  if (extension != "obj" && extension != "ply" && extension != "stl")
    throw InputError(what + ": \"" + path + "\" is not an OBJ, PLY or STL file by its name");
  const std::string where = what + ": the mesh file \"" + path + "\"";
  std::error_code unknown;
  const std::uintmax_t size = std::filesystem::file_size(path, unknown);
  if (!unknown && size > kMostBytes)
    throw InputError(where + fmt::format(" has {} bytes; {} are possible", size, kMostBytes));
  const std::string bytes = read_file(path);
  if (bytes.empty()) throw InputError(where + " is empty");
  MeshFile file;
  try {
    file = extension == "obj"   ? read_obj(bytes)
           : extension == "ply" ? read_ply(bytes)
                                : read_stl(bytes);
  } catch (const MeshFault& fault) {
    throw InputError(where + " is damaged or breaks off: " + printable(fault.text));
  }
  Triangles triangles(std::move(file), where);
  MeshData data = triangles.make();
  if (data.triangles.empty())
    throw InputError(
        where + (triangles.without_area() > 0 ? " has only faces without area" : " has no faces"));
  if (triangles.without_area() > 0)
    execution.warn(where + fmt::format(" has {} faces without area, which are left out",
                                       triangles.without_area()));
  return data;
}

}  // namespace plenoflame
