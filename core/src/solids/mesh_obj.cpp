// Wavefront OBJ: polygons by numbers of vertices, texture coordinates and normals.
#include <fmt/format.h>

#include <algorithm>

#include "solids/mesh_files.h"

namespace plenoflame {
namespace {

class ObjReader {
 public:
  MeshFile read(std::string_view text) {
    std::string joined;  // lines that a backslash continues
    while (!text.empty()) {
      std::string_view line = mesh_line(text);
      ++line_;
      const bool goes_on = line.ends_with('\\');
      if (goes_on) line.remove_suffix(1);
      if (joined.empty() && !goes_on) {
        statement(line);
        continue;
      }
      joined.append(line).append(" ");
      if (goes_on && !text.empty()) continue;
      statement(joined);
      joined.clear();
    }
    check_corners();
    return std::move(file_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw MeshFault{fmt::format("line {}: {}", line_, what)};
  }

  void statement(std::string_view line) {
    MeshWords words(line.substr(0, line.find('#')));
    const std::string_view kind = words.next();
    if (kind == "v") return vertex(words);
    if (kind == "vt") return texture(words);
    if (kind == "vn") return normal(words);
    if (kind == "f") return face(words);
    // Groups, materials, lines and free-form curves make no faces.
  }

  /// @return how many there are, of which at most `most` are kept
  std::size_t numbers(MeshWords& words, double* values, std::size_t most) const {
    std::size_t count = 0;
    for (std::string_view word = words.next(); !word.empty(); word = words.next(), ++count) {
      const std::optional<double> value = mesh_number(word);
      if (!value || !std::isfinite(*value)) fail(fmt::format("\"{}\" is not a number", word));
      if (count < most) values[count] = *value;
    }
    return count;
  }

  void vertex(MeshWords& words) {
    double v[4] = {0, 0, 0, 1};
    const std::size_t count = numbers(words, v, 4);
    if (count < 3) fail(fmt::format("a vertex of {} numbers", count));
    // Four are homogeneous coordinates; more are a colour behind the place.
    if (count == 4 && v[3] == 0) fail("a vertex of weight 0");
    const double weight = count == 4 ? v[3] : 1;
    file_.vertices.push_back({v[0] / weight, v[1] / weight, v[2] / weight});
  }
  void texture(MeshWords& words) {
    double v[2] = {0, 0};
    if (numbers(words, v, 2) < 1) fail("texture coordinates without numbers");
    file_.texture.push_back({v[0], v[1]});
  }
  void normal(MeshWords& words) {
    double v[3] = {0, 0, 0};
    if (numbers(words, v, 3) < 3) fail("a normal of fewer than 3 numbers");
    file_.normals.push_back({v[0], v[1], v[2]});
  }

  void face(MeshWords& words) {
    std::uint32_t count = 0;
    for (std::string_view word = words.next(); !word.empty(); word = words.next(), ++count)
      file_.corners.push_back(corner(word));
    if (count < 3) fail(fmt::format("a face of {} corners", count));
    file_.corner_counts.push_back(count);
    face_lines_.push_back(line_);
  }

  /// "3", "3/1", "3//2" or "3/1/2".
  MeshFile::Corner corner(std::string_view word) const {
    MeshFile::Corner corner;
    const std::array<std::pair<std::int64_t*, std::size_t>, 3> parts{
        {{&corner.vertex, file_.vertices.size()},
         {&corner.texture, file_.texture.size()},
         {&corner.normal, file_.normals.size()}}};
    std::string_view rest = word;
    for (std::size_t k = 0; k < parts.size(); ++k) {
      const auto slash = std::min(rest.find('/'), rest.size());
      const std::string_view part = rest.substr(0, slash);
      const bool last = slash == rest.size();
      rest.remove_prefix(std::min(slash + 1, rest.size()));
      if (!part.empty() || k == 0) *parts[k].first = index(part, parts[k].second, word);
      if (last) return corner;
    }
    fail(fmt::format("\"{}\" is not the number of a vertex", word));
  }

  /// Numbers count from 1, or backwards from what has been read so far.
  std::int64_t index(std::string_view part, std::size_t so_far, std::string_view word) const {
    std::int64_t number = 0;
    const char* const end = part.data() + part.size();
    const auto [at, error] = std::from_chars(part.data(), end, number);
    const auto count = static_cast<std::int64_t>(so_far);
    if (error != std::errc() || at != end || number == 0 || number < -count)
      fail(fmt::format("\"{}\" is not the number of a vertex", word));
    return number < 0 ? count + number : number - 1;
  }

  /// Faces may name what follows: only at the end it is known what there is.
  void check_corners() {
    std::size_t at = 0;
    for (std::size_t face = 0; face < file_.corner_counts.size(); ++face) {
      line_ = face_lines_[face];
      for (std::uint32_t k = 0; k < file_.corner_counts[face]; ++k, ++at) {
        const MeshFile::Corner& corner = file_.corners[at];
        const auto check = [this](const char* what, std::int64_t number, std::size_t count) {
          if (number >= static_cast<std::int64_t>(count))
            fail(fmt::format("there is no {} {} among {}", what, number + 1, count));
        };
        check("vertex", corner.vertex, file_.vertices.size());
        check("texture coordinate", corner.texture, file_.texture.size());
        check("normal", corner.normal, file_.normals.size());
      }
    }
  }

  MeshFile file_;
  std::vector<std::size_t> face_lines_;
  std::size_t line_ = 0;
};

}  // namespace

MeshFile read_obj(std::string_view text) {
  return ObjReader().read(text);
}

}  // namespace plenoflame
