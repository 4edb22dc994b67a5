#include "model/flame_generator.h"

#include <array>
#include <cmath>
#include <functional>

#include "plenoflame/base/error.h"
#include "plenoflame/base/version.h"
#include "plenoflame/volumes/flame_library.h"
#include "plenoflame/volumes/grid_writer.h"

namespace plenoflame::desktop {
namespace {

/// Called for each parameter with its name, what it is, its dimension, and itself.
using Visit = std::function<void(const char*, const char*, Dimension, double&)>;
constexpr Dimension kLength = Dimension::length, kKelvin = Dimension::temperature,
                    kNumber = Dimension::none, kAbsorption = Dimension::absorption;

void visit(LayeredFlameOptions& o, const Visit& field) {
  field("voxel size", "Spacing of the grids' samples", kLength, o.voxel_size);
}

void visit(SootFlameOptions& o, const Visit& field) {
  field("voxel size", "Spacing of the grids' samples", kLength, o.voxel_size);
  field("height", "Of the luminous flame", kLength, o.height);
  field("base radius", "Of the annulus of soot at the foot", kLength, o.base_radius);
  field("bulge", "By how much the annulus widens before it closes", kLength, o.bulge);
  field("annulus width", "Half width of the annulus, where soot has fallen to 1/e", kLength,
        o.annulus_width);
  field("core width", "Half width of the sooting core", kLength, o.core_width);
  field("core share", "Soot of the core at the tip, as a share of the annulus'", kNumber,
        o.core_share);
  field("peak volume fraction", "Of soot, where the annulus is densest", kNumber,
        o.peak_volume_fraction);
  field("peak position", "Height of the densest soot as a share of the flame's, in (0, 1)", kNumber,
        o.peak_position);
  field("sharpness", "How sharply soot peaks along the height, above 0", kNumber, o.sharpness);
  field("rim temperature", "Hottest, outside of the annulus", kKelvin, o.rim_temperature);
  field("core temperature, base", "On the axis at the foot", kKelvin, o.core_temperature_base);
  field("core temperature, tip", "On the axis at the tip", kKelvin, o.core_temperature_tip);
  field("rim distance", "Of the hottest radius outside of the annulus", kLength, o.rim_distance);
  field("inner width", "How fast temperature falls inside of the rim", kLength, o.inner_width);
  field("outer width", "How fast temperature falls outside of the rim", kLength, o.outer_width);
  field("absorption function", "E(m) of soot; published values are 0.2 to 0.4", kNumber,
        o.absorption_function);
  field("wavelength", "At which the absorption holds", kLength, o.wavelength);
}

void visit(CylinderFlameOptions& o, const Visit& field) {
  field("voxel size", "Spacing of the grids' samples", kLength, o.voxel_size);
  field("radius", "Of the cylinder", kLength, o.radius);
  field("height", "Of the cylinder", kLength, o.height);
  field("absorption", "The same everywhere in it", kAbsorption, o.absorption);
  field("temperature swing", "From the coldest to the hottest place", kKelvin, o.temperature_swing);
}

void visit(TurbulentFlameOptions& o, const Visit& field) {
  field("voxel size", "Spacing of the grids' samples", kLength, o.voxel_size);
  field("height", "Of the plume", kLength, o.height);
  field("base radius", "1/e half width at the foot", kLength, o.base_radius);
  field("spread", "Growth of the half width per height", kNumber, o.spread);
  field("smallest scale", "Of the wrinkles", kLength, o.smallest_scale);
  field("intensity", "Of displacement and fluctuation; 0: laminar", kNumber, o.intensity);
  field("peak absorption", "Of the thickest sheets", kAbsorption, o.peak_absorption);
  field("peak temperature", "Of the hottest sheets", kKelvin, o.peak_temperature);
  double seed = static_cast<double>(o.seed);
  field("seed", "Another whole number gives another flame of the same kind", kNumber, seed);
  if (!(seed >= 0) || seed != std::floor(seed) || seed > 9e15)
    throw InputError("seed: a whole number from 0 on is needed");
  o.seed = static_cast<std::uint64_t>(seed);
}

template <class Options>
std::vector<GeneratorField> defaults(Options options) {
  std::vector<GeneratorField> fields;
  visit(options, [&](const char* name, const char* about, Dimension dimension, double& value) {
    fields.push_back({name, about, dimension, format_quantity(value, dimension)});
  });
  return fields;
}

template <class Options>
Options with_values(Options options, const std::map<std::string, std::string>& values) {
  visit(options, [&](const char* name, const char*, Dimension dimension, double& value) {
    const auto found = values.find(name);
    if (found == values.end()) return;
    try {
      value = parse_quantity(found->second, dimension);
    } catch (const InputError& error) {
      throw InputError(std::string(name) + ": " + error.what());
    }
    if (!std::isfinite(value) || value < 0 || (value == 0 && dimension == kLength))
      throw InputError(std::string(name) + ": must be above 0");
  });
  return options;
}

[[noreturn]] void unknown(const std::string& name) {
  throw InputError("there is no flame '" + name +
                   "'; there are layered, candle, diffusion, cylinder, turbulent");
}

}  // namespace

std::vector<std::string> generator_names() {
  return {"candle", "diffusion", "layered", "cylinder", "turbulent"};
}

std::vector<GeneratorField> generator_fields(const std::string& name) {
  if (name == "layered") return defaults(LayeredFlameOptions{});
  if (name == "candle") return defaults(candle_flame());
  if (name == "diffusion") return defaults(diffusion_flame());
  if (name == "cylinder") return defaults(CylinderFlameOptions{});
  if (name == "turbulent") return defaults(TurbulentFlameOptions{});
  unknown(name);
}

FlameFields generate_flame(const std::string& name,
                           const std::map<std::string, std::string>& values,
                           const Execution& execution) {
  if (name == "layered")
    return make_layered_flame(with_values(LayeredFlameOptions{}, values), execution);
  if (name == "candle") return make_soot_flame(with_values(candle_flame(), values), execution);
  if (name == "diffusion")
    return make_soot_flame(with_values(diffusion_flame(), values), execution);
  if (name == "cylinder")
    return make_cylinder_flame(with_values(CylinderFlameOptions{}, values), execution);
  if (name == "turbulent")
    return make_turbulent_flame(with_values(TurbulentFlameOptions{}, values), execution);
  unknown(name);
}

void write_flame(const std::string& path, const FlameFields& fields, const std::stop_token& stop) {
  const std::array<GridOutput, 2> grids{{{&fields.temperature, "K"}, {&fields.absorption, "1/m"}}};
  GridWriteOptions options;
  options.stop = stop;
  options.metadata["creator"] = "Plenoflame " + std::string(version());
  write_grids(path, grids, options);
}

}  // namespace plenoflame::desktop
