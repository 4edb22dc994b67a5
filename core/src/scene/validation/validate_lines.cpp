// Emission lines of the flames, and whether anything sees them.
#include <fmt/format.h>

#include <algorithm>

#include "plenoflame/base/units.h"
#include "plenoflame/scene/spectral.h"
#include "scene/schema/nearest.h"
#include "scene/validation/issues.h"

namespace plenoflame {
namespace {

bool is_seen(const Scene& scene, const EmissionLine& line) {
  return std::any_of(scene.channels.begin(), scene.channels.end(), [&](const ChannelSpec& channel) {
    if (channel.kind == ChannelKind::curve && channel.curve.empty()) return true;  // not read yet
    try {
      return line.seen_by(camera_response(scene, channel)) > 0;
    } catch (const InputError&) {
      return true;  // what is wrong with the channel is said elsewhere
    }
  });
}

void check_line(const Scene& scene, const FlameSpec& flame, const LineSpec& line,
                const std::string& path, Issues& issues) {
  const bool custom = line.kind == LineKind::custom;
  if (custom && !(line.wavelength > 0)) {
    issues.error(path,
                 path + " needs a wavelength, or the kind of a known line, such as kind = \"ch\"");
    return;
  }
  if (!custom && line.wavelength != 0)
    issues.warning(path + ".wavelength", path + ".wavelength is not used: the line's kind sets it");
  if (custom && line.emission.grid.empty())
    issues.error(path, path + " needs a grid of the flame's file; set grid = \"NAME\"");
  const std::string width = path + ".width";
  if (!issues.expect(width, width, [&] { static_cast<void>(emission_line(line)); })) return;
  const EmissionLine made = emission_line(line);
  const std::string& unit = line.emission.unit;
  if (!unit.empty() && !emission_unit(unit, made.wavelength()))
    issues.error(path + ".unit", fmt::format("{}.unit is {}; it must be one of {}", path,
                                             quote_for_message(unit), emission_unit_list()));
  try {
    static_cast<void>(absorption_spectrum(flame.spectrum).factor(made.wavelength()));
  } catch (const InputError& error) {
    issues.error(path, fmt::format("{} is at {}, where the flame's absorption is not known: {}",
                                   path, short_length(made.wavelength()), error.what()));
  }
  if (!is_seen(scene, made))
    issues.warning(path, fmt::format("{} is at {}, which no channel sees; add a channel, such as "
                                     "kind = \"band\" around it",
                                     path, short_length(made.wavelength())));
}

/// Tells whether both would read one grid and count all of it.
bool count_the_same(const LineSpec& a, const LineSpec& b) {
  const auto is_c2 = [](LineKind kind) {
    return kind == LineKind::c2_474 || kind == LineKind::c2_517 || kind == LineKind::c2_564;
  };
  if (a.emission.scale != 1 || b.emission.scale != 1) return false;
  if (!a.emission.grid.empty() || !b.emission.grid.empty())
    return a.emission.grid == b.emission.grid;
  return a.kind == b.kind || (is_c2(a.kind) && is_c2(b.kind));
}

void check_grids(const FlameSpec& flame, const std::string& path, Issues& issues) {
  for (std::size_t l = 1; l < flame.lines.size(); ++l)
    for (std::size_t before = 0; before < l; ++before) {
      if (!count_the_same(flame.lines[before], flame.lines[l])) continue;
      const std::string line = fmt::format("{}[{}]", path, l);
      issues.warning(line, fmt::format("{} reads the same grid as {}[{}], so its light counts "
                                       "twice; give each its own grid, or a scale",
                                       line, path, before));
      break;
    }
}

}  // namespace

void check_lines(const Scene& scene, Issues& issues) {
  for (std::size_t i = 0; i < scene.flames.size(); ++i) {
    const FlameSpec& flame = scene.flames[i];
    const std::string path = fmt::format("flames[{}].lines", i);
    if (flame.kind == FlameKind::layered && !flame.lines.empty()) {
      issues.error(path, path +
                             " are grids of a file, but the flame is layered; set kind = "
                             "\"vdb\", or remove them");
      continue;
    }
    check_grids(flame, path, issues);
    for (std::size_t l = 0; l < flame.lines.size(); ++l)
      check_line(scene, flame, flame.lines[l], fmt::format("{}[{}]", path, l), issues);
  }
}

}  // namespace plenoflame
