// STL: triangles one by one, as text or binary.
#include <fmt/format.h>

#include <cstring>

#include "solids/mesh_files.h"

namespace plenoflame {
namespace {

constexpr std::size_t kHeader = 80, kFacet = 50;

std::uint32_t little_endian(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i)
    value |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[at + i])) << (8 * i);
  return value;
}

double float_at(std::string_view bytes, std::size_t at) {
  const std::uint32_t bits = little_endian(bytes, at);
  float value = 0;
  std::memcpy(&value, &bits, sizeof value);
  return static_cast<double>(value);
}

Vec3 vector_at(std::string_view bytes, std::size_t at) {
  return {float_at(bytes, at), float_at(bytes, at + 4), float_at(bytes, at + 8)};
}

void add_facet(Vec3 normal, const std::array<Vec3, 3>& corners, MeshFile& file) {
  const auto facet = static_cast<std::int64_t>(file.normals.size());
  for (const Vec3& corner : corners) {
    file.corners.push_back({static_cast<std::int64_t>(file.vertices.size()), -1, facet});
    file.vertices.push_back(corner);
  }
  file.corner_counts.push_back(3);
  file.normals.push_back(normal);
}

/// Binary files are recognised by the size in their header, because their text may begin with
/// "solid".
bool is_binary(std::string_view bytes) {
  return bytes.size() >= kHeader + 4 &&
         bytes.size() == kHeader + 4 + kFacet * std::size_t{little_endian(bytes, kHeader)};
}

MeshFile read_binary(std::string_view bytes) {
  MeshFile file;
  for (std::size_t at = kHeader + 4; at < bytes.size(); at += kFacet)
    add_facet(vector_at(bytes, at),
              {vector_at(bytes, at + 12), vector_at(bytes, at + 24), vector_at(bytes, at + 36)},
              file);
  return file;
}

class TextReader {
 public:
  explicit TextReader(std::string_view text) : words_(text) {}

  MeshFile read() {
    for (;;) {
      words_.skip_line();  // "solid" or "endsolid" and a name
      std::string_view word = words_.next();
      if (word.empty()) return std::move(file_);
      if (word == "solid") continue;  // another one
      for (; word == "facet"; word = words_.next()) facet();
      if (word != "endsolid") fail(file_.normals.size() + 1);
    }
  }

 private:
  [[noreturn]] static void fail(std::size_t facet) {
    throw MeshFault{fmt::format("see its facet {}", facet)};
  }
  void expect(std::string_view word) {
    if (words_.next() != word) fail(file_.normals.size() + 1);
  }
  Vec3 vector() {
    double v[3];
    for (double& value : v) {
      const std::optional<double> number = mesh_number(words_.next());
      if (!number) fail(file_.normals.size() + 1);
      value = *number;
    }
    return {v[0], v[1], v[2]};
  }
  void facet() {
    expect("normal");
    const Vec3 normal = vector();
    expect("outer");
    expect("loop");
    std::array<Vec3, 3> corners;
    for (Vec3& corner : corners) {
      expect("vertex");
      corner = vector();
    }
    expect("endloop");
    expect("endfacet");
    add_facet(normal, corners, file_);
  }

  MeshWords words_;
  MeshFile file_;
};

}  // namespace

MeshFile read_stl(std::string_view bytes) {
  if (is_binary(bytes)) return read_binary(bytes);
  if (!MeshWords(bytes).next().starts_with("solid"))
    throw MeshFault{
        "it neither begins with \"solid\", as text does, nor has the size that the number of "
        "facets in a binary header asks for"};
  return TextReader(bytes).read();
}

}  // namespace plenoflame
