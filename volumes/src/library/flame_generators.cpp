#include "plenoflame/volumes/flame_generators.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <sstream>
#include <utility>

#include "plenoflame/base/error.h"
#include "plenoflame/radiometry/emission_line.h"
#include "plenoflame/scene/spectral.h"
#include "plenoflame/volumes/flame_library.h"

namespace plenoflame {
namespace {

using Lines = std::vector<SootFlameOptions::Line>;
using Layers = std::vector<EllipsoidSpec>;
constexpr Dimension kLength = Dimension::length, kKelvin = Dimension::temperature,
                    kNumber = Dimension::none, kAbsorption = Dimension::absorption;

std::string strip(const std::string& text) {
  const auto begin = text.find_first_not_of(' ');
  if (begin == std::string::npos) return "";
  return text.substr(begin, text.find_last_not_of(' ') + 1 - begin);
}

/// "ch" or "ch=200 W/m^3": a grid of an emission line.
SootFlameOptions::Line parse_line(const std::string& text) {
  constexpr double kPeak = 100;  // [W/m^3]
  const auto equals = text.find('=');
  const std::string name = strip(text.substr(0, equals));
  std::string known;
  for (const LineGrid& line : line_grids()) {
    const std::string_view word = line_word(line.kind);
    known.append(known.empty() ? "" : ", ").append(word);
    if (name != word) continue;
    const std::string grid(line.name);
    if (equals == std::string::npos) return {grid, kPeak};
    std::istringstream value(text.substr(equals + 1));
    double number = 0;
    std::string unit;
    if (value >> number && std::getline(value >> std::ws, unit)) {
      const auto factor = emission_unit(unit, EmissionLine::named(name).wavelength());
      if (factor && number > 0) return {grid, number * *factor};
    }
    throw InputError("\"" + text + "\" needs a peak above 0 with its unit, such as " + name +
                     "=\"200 W/m^3\"");
  }
  throw InputError("there is no line \"" + name + "\"; known are " + known);
}

// Each parameter of a flame is a field of its options, visited with its name, what it is and its
// dimension. One visitor makes the table of defaults, another one sets values from text.

struct Defaults {
  std::vector<FlameParameter> list;
  void operator()(const char* name, const char* about, Dimension dimension, double& value) {
    list.push_back(
        {name, about, FlameParameterType::quantity, dimension, format_quantity(value, dimension)});
  }
  void operator()(const char* name, const char* about, std::uint64_t& value) {
    list.push_back({name, about, FlameParameterType::whole_number, kNumber, std::to_string(value)});
  }
  void operator()(const char* name, const char* about, Lines&) {
    list.push_back({name, about, FlameParameterType::lines, kNumber, ""});
  }
  void operator()(const char* name, const char* about, Layers&) {
    list.push_back({name, about, FlameParameterType::file, kNumber, ""});
  }
};

double parse(const std::string& text, std::string_view name, Dimension dimension) {
  if (name == "soot_function") {
    double value = 0;
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    if (error == std::errc() && stop == end && value > 0 && value <= kGreatestSootFunction)
      return value;
    throw InputError(
        fmt::format("E(m) of soot is above 0 and at most {:g} (published values: 0.2 to 0.4), not "
                    "{}",
                    kGreatestSootFunction, text));
  }
  const double value = parse_quantity(text, dimension);
  if (dimension == kLength && !(value > 0 && value < 1e3))
    throw InputError("\"" + text + "\" must be above 0 and below 1 km");
  if (!(std::isfinite(value) && value >= 0))
    throw InputError("\"" + text + "\" must be at least 0");
  return value;
}

std::uint64_t parse_whole(const std::string& text) {
  std::uint64_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end)
    throw InputError("a whole number from 0 to 18446744073709551615 is needed, not '" + text + "'");
  return value;
}

Lines parse_lines(const std::string& text) {
  Lines lines;
  std::istringstream items(text);
  for (std::string item; std::getline(items, item, ',');) {
    SootFlameOptions::Line line = parse_line(item);
    for (const SootFlameOptions::Line& other : lines)
      if (other.name == line.name) throw InputError(strip(item) + " is given twice");
    lines.push_back(std::move(line));
  }
  return lines;
}

/// Sets the fields that have a value.
struct Values {
  const FlameValues& values;
  template <class Set>
  void set(const char* name, const Set& set) const {
    const auto found = values.find(name);
    if (found == values.end()) return;
    try {
      set(found->second);
    } catch (const InputError& error) {
      throw InputError(std::string(name) + ": " + error.what());
    }
  }
  void operator()(const char* name, const char*, Dimension dimension, double& value) const {
    set(name, [&](const std::string& text) { value = parse(text, name, dimension); });
  }
  void operator()(const char* name, const char*, std::uint64_t& value) const {
    set(name, [&](const std::string& text) { value = parse_whole(text); });
  }
  void operator()(const char* name, const char*, Lines& value) const {
    set(name, [&](const std::string& text) { value = parse_lines(text); });
  }
  void operator()(const char* name, const char*, Layers& value) const {
    const auto found = values.find(name);  // messages of the file name it, with line and column
    if (found != values.end() && !found->second.empty()) value = read_layers(found->second);
  }
};

template <class Visit>
void visit(LayeredFlameOptions& o, Visit&& field) {
  field("voxel_size", "Spacing of the grids' samples", kLength, o.voxel_size);
  field("layers", "TOML file with [[layers]] tables; without it, three ellipsoids", o.layers);
}

template <class Visit>
void visit(SootFlameOptions& o, Visit&& field) {
  field("voxel_size", "Spacing of the grids' samples", kLength, o.voxel_size);
  field("height", "Height of the luminous flame", kLength, o.height);
  field("base_radius", "Radius of the annulus of soot at the foot", kLength, o.base_radius);
  field("bulge", "Growth of the annulus' radius before it closes", kLength, o.bulge);
  field("annulus_width", "Half width of the annulus, where soot has fallen to 1/e", kLength,
        o.annulus_width);
  field("core_width", "Half width of the sooting core", kLength, o.core_width);
  field("core_share", "Soot of the core at the tip, as a share of the annulus'", kNumber,
        o.core_share);
  field("peak_volume_fraction", "Volume fraction of soot where the annulus is densest", kNumber,
        o.peak_volume_fraction);
  field("peak_position", "Height of the densest soot as a share of the flame's, in (0, 1)", kNumber,
        o.peak_position);
  field("sharpness", "Sharpness of the peak of soot along the height, above 0", kNumber,
        o.sharpness);
  field("rim_temperature", "Highest temperature, outside of the annulus", kKelvin,
        o.rim_temperature);
  field("core_temperature_base", "Temperature on the axis at the foot", kKelvin,
        o.core_temperature_base);
  field("core_temperature_tip", "Temperature on the axis at the tip", kKelvin,
        o.core_temperature_tip);
  field("rim_distance", "Distance of the hottest radius from the annulus", kLength, o.rim_distance);
  field("inner_width", "Width over which temperature falls inside of the rim", kLength,
        o.inner_width);
  field("outer_width", "Width over which temperature falls outside of the rim", kLength,
        o.outer_width);
  field("soot_function", "Absorption function E(m) of soot; published values are 0.2 to 0.4",
        kNumber, o.absorption_function);
  field("wavelength", "Wavelength at which the absorption holds", kLength, o.wavelength);
  field("lines", "Grids of emission lines with their peaks, e.g. \"ch, na_d=2 kW/m^3\"", o.lines);
}

template <class Visit>
void visit(CylinderFlameOptions& o, Visit&& field) {
  field("voxel_size", "Spacing of the grids' samples", kLength, o.voxel_size);
  field("radius", "Radius of the cylinder", kLength, o.radius);
  field("height", "Height of the cylinder", kLength, o.height);
  field("absorption", "Absorption coefficient, uniform in the cylinder", kAbsorption, o.absorption);
  field("temperature_swing", "Difference between the coldest and the hottest place", kKelvin,
        o.temperature_swing);
}

template <class Visit>
void visit(TurbulentFlameOptions& o, Visit&& field) {
  field("voxel_size", "Spacing of the grids' samples", kLength, o.voxel_size);
  field("height", "Height of the plume", kLength, o.height);
  field("base_radius", "1/e half width at the foot", kLength, o.base_radius);
  field("spread", "Growth of the half width per height", kNumber, o.spread);
  field("smallest_scale", "Smallest scale of the wrinkles", kLength, o.smallest_scale);
  field("intensity", "Strength of displacement and fluctuation; 0: laminar", kNumber, o.intensity);
  field("peak_absorption", "Absorption coefficient of the thickest sheets", kAbsorption,
        o.peak_absorption);
  field("peak_temperature", "Temperature of the hottest sheets", kKelvin, o.peak_temperature);
  field("seed", "Seed: another whole number gives another flame of the same kind", o.seed);
}

template <auto options>
std::vector<FlameParameter> parameters_of() {
  auto values = options();
  Defaults defaults;
  visit(values, defaults);
  return std::move(defaults.list);
}

template <auto options, auto make_flame>
FlameFields make(const FlameValues& values, const Execution& execution) {
  auto chosen = options();
  visit(chosen, Values{values});
  return make_flame(chosen, execution);
}

template <class Options>
Options plain() {
  return {};
}

template <auto options, auto make_flame>
constexpr FlameGenerator row(std::string_view name, std::string_view what) {
  return {name, what, parameters_of<options>, make<options, make_flame>};
}

constexpr FlameGenerator kGenerators[]{
    row<plain<LayeredFlameOptions>, make_layered_flame>(
        "layered", "three ellipsoids, or those of a file of layers"),
    row<candle_flame, make_soot_flame>("candle", "a candle's flame, soot in an annulus"),
    row<diffusion_flame, make_soot_flame>("diffusion",
                                          "a laminar co-flow diffusion flame, soot in an annulus"),
    row<plain<CylinderFlameOptions>, make_cylinder_flame>(
        "cylinder", "a grey cylinder of 80 mm radius with a smooth temperature"),
    row<plain<TurbulentFlameOptions>, make_turbulent_flame>(
        "turbulent", "a wrinkled plume with many scales, from a seed")};

/// "a, b, c" of the names of a list.
template <class List>
std::string names_of(const List& list) {
  std::string names;
  for (const auto& item : list) names.append(names.empty() ? "" : ", ").append(item.name);
  return names;
}

const FlameParameter& find_parameter(const std::vector<FlameParameter>& list,
                                     const FlameGenerator& generator, const std::string& name) {
  const auto found =
      std::find_if(list.begin(), list.end(), [&](const auto& p) { return p.name == name; });
  if (found != list.end()) return *found;
  throw InputError("the flame '" + std::string(generator.name) + "' has no parameter '" + name +
                   "'; it has " + names_of(list));
}

}  // namespace

std::span<const FlameGenerator> flame_generators() {
  return kGenerators;
}

const FlameGenerator& flame_generator(std::string_view name) {
  for (const FlameGenerator& generator : kGenerators)
    if (generator.name == name) return generator;
  throw InputError("there is no flame '" + std::string(name) + "'; there are " +
                   names_of(kGenerators));
}

void check_flame_value(const FlameGenerator& generator, const std::string& name,
                       const std::string& value) {
  const std::vector<FlameParameter> list = generator.parameters();
  const FlameParameter& parameter = find_parameter(list, generator, name);
  switch (parameter.type) {
    case FlameParameterType::quantity:
      parse(value, name, parameter.dimension);
      break;
    case FlameParameterType::whole_number:
      parse_whole(value);
      break;
    case FlameParameterType::lines:
      parse_lines(value);
      break;
    case FlameParameterType::file:
      break;  // read when the flame is made
  }
}

FlameFields generate_flame(std::string_view name, const FlameValues& values,
                           const Execution& execution) {
  const FlameGenerator& generator = flame_generator(name);
  const std::vector<FlameParameter> list = generator.parameters();
  for (const auto& [key, value] : values) find_parameter(list, generator, key);
  return generator.make(values, execution);
}

std::map<std::string, std::string> flame_metadata(std::string_view name,
                                                  const FlameValues& values) {
  std::map<std::string, std::string> metadata{{"flame", std::string(name)}};
  for (const FlameParameter& parameter : flame_generator(name).parameters())
    if (parameter.type == FlameParameterType::whole_number)
      metadata[parameter.name] = parameter.value;
  for (const auto& [key, value] : values)
    if (key != "layers") metadata[key] = value;  // a path says nothing elsewhere
  return metadata;
}

}  // namespace plenoflame
