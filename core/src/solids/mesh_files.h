#pragma once
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "plenoflame/math/vector.h"

namespace plenoflame {

/// The content of a mesh file, before anything is made of it: faces of any number of corners.
struct MeshFile {
  /// One corner of a face: numbers of its vertex, texture coordinates and normal; -1: it has none.
  struct Corner {
    std::int64_t vertex = -1, texture = -1, normal = -1;
  };
  std::vector<Vec3> vertices;
  std::vector<Vec2> texture;
  std::vector<Vec3> normals;
  std::vector<Corner> corners;               ///< of all faces, one after the other
  std::vector<std::uint32_t> corner_counts;  ///< of each face
};

/// The fault of a file, as the rest of "the mesh file ... is damaged or breaks off: ".
struct MeshFault {
  std::string text;
};

/// Readers of whole files. Every index is checked by whoever uses it; memory stays within some
/// twenty times the file's size, whatever its header says. @throws MeshFault
MeshFile read_obj(std::string_view text);
MeshFile read_ply(std::string_view bytes);
MeshFile read_stl(std::string_view bytes);

/// The words of a text, one after the other; empty: there are no more.
class MeshWords {
 public:
  explicit MeshWords(std::string_view text) : rest_(text) {}
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

/// The whole word as a number; none when it is not one, or beyond double's range.
inline std::optional<double> mesh_number(std::string_view word) {
  double value = 0;
  const char* const end = word.data() + word.size();
  const auto [at, error] = std::from_chars(word.data(), end, value);
  if (error != std::errc() || at != end) return std::nullopt;
  return value;
}

/// Takes the next line off a text, without its end.
inline std::string_view mesh_line(std::string_view& text) {
  const auto end = std::min(text.find('\n'), text.size());
  std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

}  // namespace plenoflame
