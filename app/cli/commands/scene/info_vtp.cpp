#include <charconv>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "commands/scene/info.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/printable.h"
#include "plenoflame/image/atomic_file.h"

namespace plenoflame::cli {
namespace {

using AttributeMap = std::map<std::string, std::string, std::less<>>;

struct Tag {
  std::string name;  ///< "/Piece" for an end tag
  AttributeMap attributes;
};

/// Reads the tags of an XML file one by one, as far as files of VTK go: no entities in names, no
/// CDATA. It skips the text between tags (numbers).
class TagReader {
 public:
  explicit TagReader(std::string_view text) : text_(text) {}

  std::optional<Tag> next() {
    for (;;) {
      const std::size_t start = text_.find('<');
      if (start == std::string_view::npos) return std::nullopt;
      const std::size_t end = text_.find('>', start);
      if (end == std::string_view::npos) return std::nullopt;
      const std::string_view inside = text_.substr(start + 1, end - start - 1);
      text_.remove_prefix(end + 1);
      if (!inside.empty() && inside.front() != '?' && inside.front() != '!') return parse(inside);
    }
  }

 private:
  static Tag parse(std::string_view inside) {
    constexpr std::string_view kBlank = " \t\r\n/";
    Tag tag;
    const std::size_t name_end = inside.find_first_of(" \t\r\n", 1);
    tag.name = std::string(inside.substr(0, name_end));
    if (tag.name.size() > 1 && tag.name.back() == '/') tag.name.pop_back();
    std::string_view rest =
        name_end == std::string_view::npos ? std::string_view{} : inside.substr(name_end);
    for (;;) {
      const std::size_t start = rest.find_first_not_of(kBlank);
      if (start == std::string_view::npos) return tag;
      const std::size_t equals = rest.find('=', start);
      if (equals == std::string_view::npos || equals + 1 >= rest.size()) return tag;
      const char quote = rest[equals + 1];
      const std::size_t close = rest.find(quote, equals + 2);
      if ((quote != '"' && quote != '\'') || close == std::string_view::npos) return tag;
      tag.attributes.insert_or_assign(std::string(rest.substr(start, equals - start)),
                                      std::string(rest.substr(equals + 2, close - equals - 2)));
      rest.remove_prefix(close + 1);
    }
  }

  std::string_view text_;
};

std::string attribute(const Tag& tag, std::string_view name) {
  const auto found = tag.attributes.find(name);
  return found == tag.attributes.end() ? "" : found->second;
}

}  // namespace

void describe_poly_data(const std::string& path, Report& report) {
  const std::string text = read_file(path);
  TagReader reader(text);
  std::string type, section;
  long long points = 0, lines = 0, vertices = 0, polygons = 0;
  bool has_piece = false;
  nlohmann::json arrays = nlohmann::json::array();
  const auto add_array = [&](const std::string& place, const Tag& tag) {
    const std::string components = attribute(tag, "NumberOfComponents");
    const std::string number = components.empty() ? "1" : components;
    report.add_text(place + " array", attribute(tag, "Name") + " (" + attribute(tag, "type") +
                                          (number == "1" ? "" : " x " + number) + ")");
    arrays.push_back({{"of", place},
                      {"name", attribute(tag, "Name")},
                      {"type", attribute(tag, "type")},
                      {"components", number}});
  };
  const auto count = [&](const Tag& tag, std::string_view name) {
    constexpr long long kMost = 1'000'000'000'000;
    const std::string stated = attribute(tag, name);
    long long number = 0;
    const char* const end = stated.data() + stated.size();
    const auto [stop, error] = std::from_chars(stated.data(), end, number);
    if (!stated.empty() && (error != std::errc{} || stop != end || number < 0 || number > kMost))
      throw InputError("'" + path + "': " + std::string(name) + " of a Piece is '" +
                       printable(stated) +
                       "', which is no number of such things; the file is damaged");
    return number;
  };
  report.add("type", "ray paths or geometry (VTK PolyData)", "type", "poly data");
  while (const std::optional<Tag> tag = reader.next()) {
    if (tag->name == "VTKFile") type = attribute(*tag, "type");
    if (tag->name == "AppendedData") break;  // binary from here
    if (tag->name == "PointData") section = "point";
    if (tag->name == "CellData") section = "cell";
    if (tag->name == "FieldData") section = "file";
    if (tag->name.starts_with('/') && tag->name != "/DataArray") section.clear();
    if (tag->name == "DataArray" && !section.empty()) add_array(section, *tag);
    if (tag->name != "Piece") continue;
    has_piece = true;
    points += count(*tag, "NumberOfPoints");
    lines += count(*tag, "NumberOfLines");
    vertices += count(*tag, "NumberOfVerts");
    polygons += count(*tag, "NumberOfPolys");
  }
  if (type != "PolyData" || !has_piece)
    throw InputError("'" + path + "' is a VTK file of type '" + printable(type) +
                     "'; only PolyData (.vtp) is known, and it needs a Piece");
  const std::size_t last = text.find_last_not_of(" \t\r\n");
  if (last == std::string::npos || !text.substr(0, last + 1).ends_with("</VTKFile>"))
    throw InputError("'" + path + "' has no </VTKFile> at its end: the file was cut short");
  report.add("points", std::to_string(points), "points", points);
  report.add("lines", std::to_string(lines), "lines", lines);
  if (vertices > 0) report.add_text("vertices", std::to_string(vertices));
  if (polygons > 0) report.add_text("polygons", std::to_string(polygons));
  report.add_json("vertices", vertices);
  report.add_json("polygons", polygons);
  report.add_json("arrays", arrays);
}

}  // namespace plenoflame::cli
