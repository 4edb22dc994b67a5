#include <algorithm>

#include "plenoflame/base/error.h"
#include "plenoflame/volumes/flame_library.h"
#include "vtk_commands.h"

namespace plenoflame {
namespace {

using R = FlameImportRequest;

/// Its default is told by the help.
std::string untold(const R&) {
  return "";
}

/// A quantity above 0.
template <double R::*Member, Dimension dimension>
SettingText<R> positive() {
  return {untold, [](R& r, const SettingReader& value) {
            r.*Member = value.quantity(dimension);
            if (!(r.*Member > 0)) throw UsageError(value.setting() + ": must be above 0");
          }};
}

void set_bounds(R& r, const SettingReader& value) {
  const std::vector<std::string> ends = value.list();
  if (ends.size() != r.bounds.size())
    throw UsageError(value.setting() +
                     ": six lengths are needed: x low, x high, y low, y high, z low, z high");
  for (std::size_t k = 0; k < ends.size(); ++k)
    r.bounds[k] = SettingReader(value.setting(), ends[k]).quantity(Dimension::length);
  for (std::size_t k = 0; k < ends.size(); k += 2)
    if (!(r.bounds[k] < r.bounds[k + 1]))
      throw UsageError(value.setting() + ": each low bound must be below its high one");
}

}  // namespace

template <>
std::span<const SettingRow<FlameImportRequest>> setting_rows() {
  using enum SettingKind;
  constexpr SettingRange kFactors{1e-12, 1e12};
  static const std::vector<SettingRow<R>> rows{
      {"solution", "FILE", "PLOT3D: the solution (.q) of the grid", &R::solution, file},
      {"temperature", "ARRAY", "Array of the temperature", &R::temperature},
      {"temperature-unit", "UNIT", "K or degC", &R::temperature_unit, any_of("K", "degC")},
      {"temperature-scale", "F", "Factor on the stored temperatures", &R::temperature_scale,
       kFactors},
      {"absorption", "ARRAY", "Array of the absorption coefficient", &R::absorption},
      {"absorption-unit", "UNIT", "1/m, 1/cm or 1/mm", &R::absorption_unit,
       any_of("1/m", "1/cm", "1/mm")},
      {"soot", "ARRAY", "Array of the volume fraction of soot", &R::soot},
      {"soot-function", "E", "E(m) of soot, 0.2 to 0.4", &R::soot_function,
       between(1e-6, kGreatestSootFunction)},
      {"wavelength", "LENGTH", "Wavelength at which the absorption holds (650 nm)",
       positive<&R::wavelength, Dimension::length>(), lengths},
      {"constant", "ABSORPTION", "Uniform absorption in the mesh, e.g. \"20 1/m\"",
       positive<&R::constant, Dimension::absorption>()},
      {"voxel-size", "LENGTH", "Edge of a voxel (a 128th of the longest side)",
       positive<&R::voxel_size, Dimension::length>(), lengths},
      {"bounds", "BOX", "Part to import: x low, x high, y low, y high, z low, z high, with units",
       SettingText<R>{untold, set_bounds}, lengths},
      {"length-scale", "F", "Metres per unit of the mesh", &R::length_scale, kFactors}};
  return rows;
}

}  // namespace plenoflame
