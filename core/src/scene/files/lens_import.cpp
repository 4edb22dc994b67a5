#include <algorithm>
#include <charconv>
#include <cmath>

#include "plenoflame/base/error.h"
#include "plenoflame/base/units.h"
#include "plenoflame/optics/surface_shape.h"
#include "plenoflame/scene/lens_file.h"
#include "scene/schema/nearest.h"

namespace plenoflame {
namespace {

std::vector<std::string> columns_of(std::string_view line) {
  std::vector<std::string> columns;
  std::string word;
  for (const char c : line) {
    const bool separator = c == ' ' || c == '\t' || c == '\r' || c == ',' || c == ';';
    if (!separator) word += c;
    if (!separator || word.empty()) continue;
    columns.push_back(word);
    word.clear();
  }
  if (!word.empty()) columns.push_back(word);
  return columns;
}

}  // namespace

LensFile import_four_columns(std::string_view text, const std::string& name) {
  LensFile file;
  int number = 0;
  while (!text.empty()) {
    const auto end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    ++number;
    const auto hash = line.find('#');
    if (hash != std::string_view::npos) {
      if (file.title.empty()) {
        const auto words = line.substr(hash).find_first_not_of("# \t");
        if (words != std::string_view::npos)
          file.title = std::string(
              line.substr(hash + words, line.find_last_not_of(" \r") + 1 - hash - words));
      }
      line = line.substr(0, hash);
    }
    const auto columns = columns_of(line);
    if (columns.empty()) continue;
    const SourcePosition here{name, number};
    if (columns.size() != 4)
      throw InputError(here,
                       "this line has " + std::to_string(columns.size()) +
                           " columns, but four are needed: radius, thickness, index and diameter");
    double values[4];
    for (std::size_t i = 0; i < 4; ++i) {
      try {
        values[i] = i == 2 ? parse_quantity(columns[i], Dimension::none)
                           : parse_quantity(columns[i] + " mm", Dimension::length);
      } catch (const InputError&) {
        throw InputError(here, quote_for_message(columns[i]) + " is not a number");
      }
    }
    SurfaceSpec surface;
    surface.stop = values[0] == 0;
    surface.radius = surface.stop ? kInfinity : values[0];
    surface.thickness = values[1];
    surface.diameter = values[3];
    // Air is 1, or 0 by an old custom; behind the stop it is what it was before it.
    surface.index = values[2] == 0 ? 1 : values[2];
    if (!(surface.index >= 1 && surface.index <= 5))
      throw InputError(here, "the index is " + columns[2] + "; it must be 1 to 5");
    if (!(surface.diameter > 0)) throw InputError(here, "the clear diameter is not positive");
    if (!(surface.thickness >= 0)) throw InputError(here, "the thickness is negative");
    if (surface.diameter > 2 * greatest_height(surface))
      throw InputError(here, "a sphere of this radius cannot have this diameter");
    file.lens.surfaces.push_back(surface);
  }
  if (file.lens.surfaces.empty())
    throw InputError(SourcePosition{name}, "the file has no surfaces");
  const auto is_stop = [](const SurfaceSpec& surface) { return surface.stop; };
  if (std::none_of(file.lens.surfaces.begin(), file.lens.surfaces.end(), is_stop))
    throw InputError(SourcePosition{name},
                     "the file has no aperture stop; a line of radius 0 is one");
  SurfaceSpec& last = file.lens.surfaces.back();
  if (last.index != 1)
    throw InputError(SourcePosition{name}, "the index behind the last surface is " +
                                               std::to_string(last.index) +
                                               ", but it must be that of air, 1");
  file.image_distance = last.thickness;
  last.thickness = 0;
  return file;
}

}  // namespace plenoflame
