#include "plenoflame/volumes/flame_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <span>
#include <string_view>

#include "field.h"
#include "plenoflame/base/error.h"
#include "plenoflame/scene/spectral.h"
#include "plenoflame/volumes/grid_file.h"
#include "plenoflame/volumes/vdb_info.h"

namespace plenoflame {
namespace {

constexpr double kZeroCelsius = 273.15;     // [K]
constexpr double kHottest = 1e5;            // [K] as for layers
constexpr double kSuspiciousMaximum = 200;  // [K] a flame is hotter in any unit but these

/// SI value = factor * value + shift.
struct Unit {
  std::string_view name;
  double factor;
  double shift;
  bool fraction = false;  ///< a volume fraction of soot
};

// The first of each list is what the scene file documents; the others occur in files.
constexpr Unit kTemperatureUnits[] = {{"k", 1, 0},
                                      {"degc", 1, kZeroCelsius},
                                      {"kelvin", 1, 0},
                                      {"celsius", 1, kZeroCelsius},
                                      {"c", 1, kZeroCelsius},
                                      {"\xc2\xb0"
                                       "c",
                                       1, kZeroCelsius}};
constexpr Unit kAbsorptionUnits[] = {{"1/m", 1, 0},     {"1/cm", 100, 0},      {"1/mm", 1000, 0},
                                     {"m^-1", 1, 0},    {"cm^-1", 100, 0},     {"mm^-1", 1000, 0},
                                     {"m-1", 1, 0},     {"cm-1", 100, 0},      {"mm-1", 1000, 0},
                                     {"1", 1, 0, true}, {"ppm", 1e-6, 0, true}};

constexpr std::string_view kTemperatureNames[] = {"temperature",     "temp",           "t", "heat",
                                                  "temperaturegrid", "gas_temperature"};
constexpr std::string_view kAbsorptionNames[] = {"absorption",
                                                 "absorption_coefficient",
                                                 "absorption_coeff",
                                                 "absorptiongrid",
                                                 "kappa",
                                                 "kappa_a",
                                                 "sigma_a"};
constexpr std::string_view kChNames[] = {"ch*", "ch_star", "ch_emission", "ch"};
constexpr std::string_view kC2Names[] = {"c2*", "c2_star", "c2_emission", "c2"};
constexpr std::string_view kOhNames[] = {"oh*", "oh_star", "oh_emission", "oh"};
constexpr std::string_view kSodiumNames[] = {"na_d", "na", "na_emission", "sodium"};
constexpr LineGrid kLineGrids[] = {{LineKind::ch, "CH*"},
                                   {LineKind::c2_517, "C2*"},
                                   {LineKind::oh, "OH*"},
                                   {LineKind::na_d, "Na_D"}};
constexpr std::string_view kDensityNames[] = {"density"};

/// One of the two grids of a flame that are read.
struct Quantity {
  const char* name;  ///< as in the scene's keys
  const char* si_unit;
  const char* units;  ///< for messages
  std::span<const Unit> table;
  std::span<const std::string_view> names;
};

Quantity temperature() {
  return {"temperature", "K", "K or degC", kTemperatureUnits, kTemperatureNames};
}
Quantity absorption() {
  return {"absorption", "1/m", "1/m, 1/cm or 1/mm, or 1 or ppm of soot", kAbsorptionUnits,
          kAbsorptionNames};
}

/// Emission lines have units of their own: their table is empty.
Quantity emission(const LineSpec& line) {
  return {"lines", "W/m^3", "", {}, line_grid_names(line.kind)};
}

const GridInfo* choose(const std::vector<GridInfo>& grids, std::span<const std::string_view> names,
                       bool readable = true) {
  for (const std::string_view name : names)
    for (const GridInfo& grid : grids)
      if (grid.readable == readable && detail::lower_case(grid.name) == name) return &grid;
  return nullptr;
}

std::string list_of(const std::vector<GridInfo>& grids) {
  std::string text;
  for (const GridInfo& grid : grids)
    text += fmt::format("{}\"{}\" ({})", text.empty() ? "" : ", ", grid.name, grid.value_type);
  return text.empty() ? "none" : text;
}

[[noreturn]] void missing(const std::string& path, const Quantity& quantity,
                          const std::vector<GridInfo>& grids) {
  std::string hint = fmt::format("name one of them with {}.grid in the scene", quantity.name);
  if (quantity.table.empty())
    throw InputError(fmt::format("{}: has no grid for {}; it holds: {}; {}", path, quantity.name,
                                 list_of(grids), hint));
  if (std::string_view(quantity.name) == "absorption" && choose(grids, kDensityNames) != nullptr)
    hint =
        "to take it from the smoke density, set absorption.grid = \"density\" and "
        "absorption.scale to the absorption [1/m] of density 1";
  throw InputError(fmt::format("{}: has no {} grid; it holds: {}; {}", path, quantity.name,
                               list_of(grids), hint));
}

Unit unit_of(const std::string& path, const GridSpec& spec, const GridInfo& info,
             const Quantity& quantity) {
  const bool from_scene = !spec.unit.empty();
  const std::string& name = from_scene ? spec.unit : info.unit;
  if (name.empty()) return quantity.table[0];
  for (const Unit& unit : quantity.table)
    if (unit.name == detail::lower_case(name)) return unit;
  throw InputError(
      from_scene ? fmt::format("{}: {}.unit \"{}\" is not known; use {}", path, quantity.name, name,
                               quantity.units)
                 : fmt::format("{}: grid \"{}\" states the unit \"{}\", which is not known; set "
                               "{}.unit in the scene to {}",
                               path, info.name, name, quantity.name, quantity.units));
}

void check_value(const std::string& path, const VoxelField& field, const Quantity& quantity,
                 float value, const std::string& where) {
  if (std::isfinite(value) && value >= 0) return;
  throw InputError(fmt::format("{}: grid \"{}\": {} is {:g} {}; it must be {}", path, field.name,
                               where, value, quantity.si_unit,
                               std::isfinite(value) ? "at least 0" : "a finite number"));
}

/// Applies the mapping in double precision and checks every voxel.
void convert(const std::string& path, VoxelField& field, const GridSpec& spec, const Unit& unit,
             const Quantity& quantity) {
  const auto si = [&](float stored) {
    return static_cast<float>(
        unit.factor * (spec.scale * static_cast<double>(stored) + spec.offset) + unit.shift);
  };
  field.background = si(field.background);
  check_value(path, field, quantity, field.background, "the background");
  for (std::size_t i = 0; i < field.values.size(); ++i) {
    const float value = field.values[i] = si(field.values[i]);
    if (!(value >= 0) || !std::isfinite(value))
      check_value(path, field, quantity, value,
                  "voxel " + detail::to_string(detail::voxel_index(field, i / detail::kBrickValues,
                                                                   i % detail::kBrickValues)));
  }
}

/// Index of a name with several grids: the name that read_voxel_field takes for this very grid.
VoxelField read_stored(const std::string& path, const std::vector<GridInfo>& grids,
                       const GridSpec& spec, const Quantity& quantity) {
  if (!std::isfinite(spec.scale) || spec.scale == 0 || !std::isfinite(spec.offset))
    throw InputError(
        fmt::format("{}: {}.scale must be a finite number other than 0, and {}.offset a "
                    "finite number",
                    path, quantity.name, quantity.name));
  std::string name = spec.grid;
  if (name.empty()) {
    const GridInfo* chosen = choose(grids, quantity.names);
    // Reading one that cannot be read says why.
    if (chosen == nullptr) chosen = choose(grids, quantity.names, /*readable=*/false);
    if (chosen == nullptr) missing(path, quantity, grids);
    name = chosen->name;
  }
  return read_voxel_field(path, name);
}

VoxelField read(const std::string& path, const std::vector<GridInfo>& grids, const GridSpec& spec,
                const Quantity& quantity, double per_fraction = 0) {
  VoxelField field = read_stored(path, grids, spec, quantity);
  const auto info = std::find_if(grids.begin(), grids.end(),
                                 [&](const GridInfo& grid) { return grid.name == field.name; });
  Unit unit = unit_of(path, spec, *info, quantity);
  if (unit.fraction) {
    if (!(per_fraction > 0))
      throw InputError(
          fmt::format("{}: grid \"{}\" is a volume fraction, which needs the spectrum of soot; set "
                      "spectrum.kind = \"soot\" for this flame",
                      path, field.name));
    unit.factor *= per_fraction;
  }
  convert(path, field, spec, unit, quantity);
  return field;
}

/// Light of an emission line, of the flame's line number `index`.
VoxelField read_line(const std::string& path, const std::vector<GridInfo>& grids,
                     const LineSpec& line, std::size_t index) {
  const std::string key = fmt::format("lines[{}]", index);
  Quantity quantity = emission(line);
  quantity.name = key.c_str();
  VoxelField field = read_stored(path, grids, line.emission, quantity);
  const auto info = std::find_if(grids.begin(), grids.end(),
                                 [&](const GridInfo& grid) { return grid.name == field.name; });
  const bool from_scene = !line.emission.unit.empty();
  const std::string& name = from_scene ? line.emission.unit : info->unit;
  const auto factor = emission_unit(name, emission_line(line).wavelength());
  if (name.empty())
    throw InputError(fmt::format("{}: grid \"{}\" states no unit; set {}.unit in the scene to {}",
                                 path, field.name, key, emission_unit_list()));
  if (!factor)
    throw InputError(
        from_scene ? fmt::format("{}: {}.unit \"{}\" is not known; use {}", path, key, name,
                                 emission_unit_list())
                   : fmt::format("{}: grid \"{}\" states the unit \"{}\", which is not one of "
                                 "emission; set {}.unit in the scene to {}",
                                 path, field.name, name, key, emission_unit_list()));
  convert(path, field, line.emission, {name, *factor, 0}, quantity);
  if (field.background != 0)
    throw InputError(fmt::format(
        "{}: grid \"{}\" has the background {:g} W/m^3; it must be 0, or all of space would glow",
        path, field.name, field.background));
  return field;
}

VoxelField read_albedo(const std::string& path, const std::string& name) {
  VoxelField field = read_voxel_field(path, name);
  const auto check = [&](float value, const std::string& where) {
    if (value >= 0 && value < 1) return;
    throw InputError(
        fmt::format("{}: grid \"{}\": {} is an albedo of {:g}; it must be at least 0 and below 1{}",
                    path, field.name, where, value,
                    value > 1 && value <= 100 ? " (is the grid in percent?)"
                    : value == 1              ? ", which makes scattering infinite"
                                              : ""));
  };
  check(field.background, "the background");
  for (std::size_t i = 0; i < field.values.size(); ++i)
    if (const float value = field.values[i]; !(value >= 0 && value < 1))
      check(value, "voxel " + detail::to_string(detail::voxel_index(field, i / detail::kBrickValues,
                                                                    i % detail::kBrickValues)));
  return field;
}

/// Nothing that absorbs, on another field's samples.
VoxelField nothing_on(const VoxelField& samples, const char* name, double background) {
  VoxelField field;
  field.name = name;
  field.index_to_world = samples.index_to_world;
  field.background = static_cast<float>(background);
  return field;
}

/// True if a flame of emission lines has no absorption, nor asks for anything that needs one.
bool is_clear(const FlameSpec& spec, const std::vector<GridInfo>& grids) {
  return !spec.lines.empty() && spec.absorption == GridSpec{} && spec.temperature == GridSpec{} &&
         !spec.scattering.present() && choose(grids, kAbsorptionNames) == nullptr &&
         choose(grids, kAbsorptionNames, /*readable=*/false) == nullptr;
}

bool names_a_line(const std::string& grid) {
  for (const LineGrid& line : kLineGrids)
    for (const std::string_view name : line_grid_names(line.kind))
      if (detail::lower_case(grid) == name) return true;
  return false;
}

/// A clear flame: nothing to say about a file of emission alone, but another grid may have been
/// meant to absorb.
FlameFields clear_flame(const std::string& path, const std::vector<GridInfo>& grids,
                        std::vector<VoxelField> lines, const Execution& execution) {
  constexpr double kAmbient = 293.15;
  std::vector<GridInfo> unused;
  for (const GridInfo& grid : grids)
    if (grid.readable && !names_a_line(grid.name) &&
        std::none_of(lines.begin(), lines.end(),
                     [&](const VoxelField& line) { return line.name == grid.name; }))
      unused.push_back(grid);
  if (!unused.empty())
    execution.warn(
        fmt::format("{}: no grid has a known name for absorption, so only emission lines are seen; "
                    "not used: {}; name the absorption with absorption.grid in the scene",
                    path, list_of(unused)));
  VoxelField nothing = nothing_on(lines.front(), "absorption", 0);
  return {nothing_on(lines.front(), "temperature", kAmbient), std::move(nothing), std::move(lines)};
}

}  // namespace

std::span<const std::string_view> line_grid_names(LineKind line) {
  switch (line) {
    case LineKind::ch:
      return kChNames;
    case LineKind::c2_474:
    case LineKind::c2_517:
    case LineKind::c2_564:
      return kC2Names;
    case LineKind::oh:
      return kOhNames;
    case LineKind::na_d:
      return kSodiumNames;
    case LineKind::custom:
      break;
  }
  return {};
}

std::span<const LineGrid> line_grids() {
  return kLineGrids;
}

std::span<const std::string_view> temperature_grid_names() {
  return kTemperatureNames;
}
std::span<const std::string_view> absorption_grid_names() {
  return kAbsorptionNames;
}

std::vector<VoxelField> read_flame_grids(const std::string& path, const Execution& execution) {
  std::vector<VoxelField> fields;
  const std::vector<GridInfo> grids = list_grids(path, /*statistics=*/false);
  const bool readable =
      std::any_of(grids.begin(), grids.end(), [](const GridInfo& grid) { return grid.readable; });
  if (readable && choose(grids, kTemperatureNames) == nullptr &&
      choose(grids, kAbsorptionNames) == nullptr) {
    std::map<std::string, int> before;
    for (const GridInfo& grid : grids) {
      const int number = before[grid.name]++;
      if (!grid.readable) continue;
      fields.push_back(read_voxel_field(
          path, number == 0 ? grid.name : fmt::format("{}[{}]", grid.name, number)));
    }
    return fields;
  }
  FlameSpec spec;
  spec.kind = FlameKind::vdb;
  spec.file = path;
  FlameFields flame = read_flame(spec, "", execution);
  flame.temperature.name = "temperature";
  flame.absorption.name = "absorption";
  fields.push_back(std::move(flame.temperature));
  fields.push_back(std::move(flame.absorption));
  return fields;
}

FlameFields read_flame(const FlameSpec& spec, const std::string& scene_folder,
                       const Execution& execution) {
  std::filesystem::path file(spec.file);
  if (file.is_relative() && !scene_folder.empty())
    file = std::filesystem::path(scene_folder) / file;
  const std::string path = file.string();
  const std::vector<GridInfo> grids = list_grids(path, /*statistics=*/false);
  std::vector<VoxelField> lines;
  for (std::size_t i = 0; i < spec.lines.size(); ++i)
    lines.push_back(read_line(path, grids, spec.lines[i], i));
  if (is_clear(spec, grids)) return clear_flame(path, grids, std::move(lines), execution);
  FlameFields flame{read(path, grids, spec.temperature, temperature()),
                    read(path, grids, spec.absorption, absorption(),
                         absorption_spectrum(spec.spectrum).per_volume_fraction()),
                    std::move(lines)};
  if (!spec.scattering.grid.empty()) flame.albedo = read_albedo(path, spec.scattering.grid);
  if (flame.absorption.background != 0)
    throw InputError(fmt::format(
        "{}: grid \"{}\" has the background {:g} 1/m; it must be 0, or all of space would absorb",
        path, flame.absorption.name, flame.absorption.background));
  if (flame.absorption.brick_origins.empty() && flame.lines.empty())
    execution.warn(fmt::format("{}: grid \"{}\" is 0 everywhere: the flame is invisible", path,
                               flame.absorption.name));
  const auto range = detail::range(flame.temperature);
  const double hottest = range ? std::fmax(range->maximum, flame.temperature.background)
                               : flame.temperature.background;
  if (hottest > kHottest)
    throw InputError(
        fmt::format("{}: grid \"{}\" is {:g} K at most, above {:g} K; if it has another unit, set "
                    "temperature.unit or temperature.scale in the scene",
                    path, flame.temperature.name, hottest, kHottest));
  if (hottest < kSuspiciousMaximum)
    execution.warn(
        fmt::format("{}: grid \"{}\" is {:g} K at most; if it is in degC or normalised, set "
                    "temperature.unit or temperature.scale in the scene",
                    path, flame.temperature.name, hottest));
  return flame;
}

VdbInfo vdb_info(const std::string& path) {
  VdbInfo info;
  info.file = path;
  info.grids = list_grids(path);
  std::error_code error;
  info.file_size = std::filesystem::file_size(path, error);
  const auto remark = [&](std::string text) { info.remarks.push_back(std::move(text)); };
  for (const LineGrid& line : kLineGrids)
    if (const GridInfo* grid = choose(info.grids, line_grid_names(line.kind)); grid != nullptr) {
      const std::string kind(line_word(line.kind));
      info.lines.push_back({grid->name, kind});
      if (!emission_unit(grid->unit, 500e-9))
        remark(
            fmt::format("grid \"{}\" states no unit of emission: as the emission line \"{}\" it "
                        "needs lines[].unit",
                        grid->name, kind));
    }
  const GridInfo* hot = choose(info.grids, temperature_grid_names());
  const GridInfo* sooty = choose(info.grids, absorption_grid_names());
  constexpr std::array<std::string_view, 1> kReconstructed{"emission"};
  info.emission_alone = hot == nullptr && sooty == nullptr && info.lines.empty() &&
                        choose(info.grids, kReconstructed) != nullptr;
  if (info.emission_alone) {
    remark(
        "grid \"emission\" was reconstructed without an absorption, so there is no temperature; in "
        "a "
        "scene it is the grid of an emission line");
    return info;
  }
  if (hot != nullptr) {
    info.temperature_grid = hot->name;
    if (hot->unit.empty())
      remark(fmt::format("grid \"{}\" states no unit; it is taken to be in K", hot->name));
    if (std::fmax(hot->maximum, hot->background) < kSuspiciousMaximum)
      remark(
          fmt::format("grid \"{}\" is {:g} at most: if that is not in K, a scene needs "
                      "temperature.unit or temperature.scale",
                      hot->name, std::fmax(hot->maximum, hot->background)));
  } else if (sooty != nullptr || info.lines.empty()) {
    remark("no grid has a known name for temperature; name one with temperature.grid in the scene");
  }
  if (sooty != nullptr) {
    info.absorption_grid = sooty->name;
    if (sooty->unit.empty())
      remark(fmt::format("grid \"{}\" states no unit; it is taken to be in 1/m", sooty->name));
    if (sooty->background != 0)
      remark(fmt::format("grid \"{}\" has the background {:g}, which must be 0 for absorption",
                         sooty->name, sooty->background));
  } else if (!info.lines.empty()) {
    remark(
        "no grid has a known name for absorption: the flame only emits lines and absorbs nothing");
  } else {
    remark(
        "no grid has a known name for absorption; name one with absorption.grid in the scene, for "
        "example \"density\" with absorption.scale");
  }
  for (const GridInfo& grid : info.grids)
    if (!grid.readable)
      remark(fmt::format("grid \"{}\" ({}, {}) cannot be used as temperature or absorption",
                         grid.name, grid.value_type, grid.transform_type));
  return info;
}

}  // namespace plenoflame
