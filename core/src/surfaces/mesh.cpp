#include "surfaces/mesh.h"

#include <fmt/format.h>

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <algorithm>
#include <assimp/Importer.hpp>
#include <cctype>
#include <charconv>
#include <cmath>
#include <string_view>

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

/// Reads the words of a text, one after the other.
class Words {
 public:
  explicit Words(std::string_view text) : rest_(text) {}
  std::string_view next() {
    const auto begin = rest_.find_first_not_of(kBlank);
    if (begin == std::string_view::npos) return rest_ = {};
    rest_.remove_prefix(begin);
    const std::string_view word = rest_.substr(0, rest_.find_first_of(kBlank));
    rest_.remove_prefix(word.size());
    return word;
  }
  void skip_line() { rest_.remove_prefix(std::min(rest_.size(), rest_.find('\n'))); }

 private:
  static constexpr std::string_view kBlank = " \t\r\n\v\f";
  std::string_view rest_;
};

/// The importer does not come to an end with a text STL file that breaks off or holds words of its
/// own: here is what makes one complete. @return number of its first facet that is not; 0: all are
std::size_t first_broken_facet(std::string_view text) {
  Words words(text);
  std::size_t facet = 0;
  for (;;) {
    words.skip_line();  // "solid" or "endsolid" and a name
    std::string_view word = words.next();
    if (word.empty()) return 0;
    if (word == "solid") continue;  // another one
    for (; word == "facet"; word = words.next()) {
      ++facet;
      if (words.next() != "normal") return facet;
      for (int i = 0; i < 3; ++i) words.next();
      if (words.next() != "outer" || words.next() != "loop") return facet;
      for (int corner = 0; corner < 3; ++corner) {
        if (words.next() != "vertex") return facet;
        for (int i = 0; i < 3; ++i) words.next();
      }
      if (words.next() != "endloop" || words.next() != "endfacet") return facet;
    }
    if (word != "endsolid") return facet + 1;
  }
}

/// As the importer tells them apart: by the size that a binary file's header gives.
bool is_text_stl(std::string_view bytes) {
  constexpr std::size_t kHeader = 80, kFacet = 50;
  if (bytes.size() >= kHeader + 4) {
    std::uint32_t facets = 0;
    for (std::size_t i = 0; i < 4; ++i)
      facets |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[kHeader + i]))
                << (8 * i);
    if (bytes.size() == kHeader + 4 + kFacet * facets) return false;
  }
  return Words(bytes).next().starts_with("solid");
}

/// The importer does not come to an end with a PLY file without end of header, and makes up what is
/// missing at the end of one in text. @return what is wrong; empty: nothing
std::string ply_fault(std::string_view text) {
  bool in_text = false;
  double rows = 0;
  for (bool header = true; header;) {
    if (text.empty()) return "its header does not end";
    const auto end = std::min(text.find('\n'), text.size());
    Words words(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    const std::string_view first = words.next();
    if (first == "format") in_text = words.next() == "ascii";
    if (first == "element") {
      words.next();
      const std::string_view count = words.next();
      double number = 0;
      const auto [stop, error] = std::from_chars(count.data(), count.data() + count.size(), number);
      if (error != std::errc() || !(number >= 0)) return "its header gives no number of elements";
      rows += number;
    }
    header = first != "end_header";
  }
  if (!in_text) return "";
  double lines = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    lines += Words(text.substr(at, end - at)).next().empty() ? 0 : 1;
    at = end + 1;
  }
  return lines < rows ? fmt::format("it has {} of {} lines of data", lines, rows) : "";
}

/// The importer takes what it can of an OBJ file: a number that is none becomes 0, a face of two
/// corners is left out. @return what is wrong, with its line; empty: nothing
std::string obj_fault(std::string_view text) {
  struct Corner {
    std::size_t line;
    long vertex;
  };
  std::vector<Corner> corners;
  long vertices = 0;
  std::size_t line = 0;
  std::string joined;  // lines that a backslash continues
  while (!text.empty()) {
    const auto end = std::min(text.find('\n'), text.size());
    std::string_view part = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    ++line;
    if (part.ends_with('\r')) part.remove_suffix(1);
    const bool goes_on = part.ends_with('\\');
    if (goes_on) part.remove_suffix(1);
    joined += part;
    if (goes_on && !text.empty()) continue;
    Words words(joined);
    const std::string_view kind = words.next();
    if (kind == "v") {
      ++vertices;
      int numbers = 0;
      for (std::string_view word = words.next(); !word.empty(); word = words.next(), ++numbers) {
        double value = 0;
        const char* const stop = word.data() + word.size();
        const auto [at, error] = std::from_chars(word.data(), stop, value);
        if (word.front() == '#') break;
        if (error != std::errc() || at != stop || !std::isfinite(value))
          return fmt::format("line {}: \"{}\" is not a number", line, word);
      }
      if (numbers < 3) return fmt::format("line {}: a vertex of {} numbers", line, numbers);
    } else if (kind == "f") {
      int count = 0;
      for (std::string_view word = words.next(); !word.empty(); word = words.next(), ++count) {
        if (word.front() == '#') break;
        long index = 0;
        const char* const stop = word.data() + word.size();
        const auto [at, error] = std::from_chars(word.data(), stop, index);
        if (error != std::errc() || (at != stop && *at != '/') || index == 0)
          return fmt::format("line {}: \"{}\" is not the number of a vertex", line, word);
        corners.push_back({line, index < 0 ? vertices + index + 1 : index});
      }
      if (count < 3) return fmt::format("line {}: a face of {} corners", line, count);
    }
    joined.clear();
  }
  for (const Corner& corner : corners)
    if (corner.vertex < 1 || corner.vertex > vertices)
      return fmt::format("line {}: there is no vertex {} among {}", corner.line, corner.vertex,
                         vertices);
  return "";
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
  const std::string where = what + ": the mesh file \"" + path + "\"";
  if (extension == "stl") {
    const std::size_t broken = is_text_stl(bytes) ? first_broken_facet(bytes) : 0;
    if (broken > 0)
      throw InputError(where + fmt::format(" is damaged or breaks off: see its facet {}", broken));
  }
  const std::string fault = extension == "ply"   ? ply_fault(bytes)
                            : extension == "obj" ? obj_fault(bytes)
                                                 : "";
  if (!fault.empty()) throw InputError(where + " is damaged or breaks off: " + fault);
  if (bytes.empty()) throw InputError(where + " is empty");
  Assimp::Importer importer;
  // From memory, so that a file cannot make the importer open others.
  const aiScene* scene = importer.ReadFileFromMemory(bytes.data(), bytes.size(),
                                                     aiProcess_Triangulate, extension.c_str());
  if (!scene) {
    std::string reason = importer.GetErrorString();
    std::replace(reason.begin(), reason.end(), '\n', ' ');
    // What the library calls a file in memory.
    const std::string alias = "$$$___magic___$$$." + extension;
    if (const auto at = reason.find(alias); at != std::string::npos)
      reason.replace(at, alias.size(), "the file");
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
